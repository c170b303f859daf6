// The types of what is declared, in TypeScript: js/declared_types.mjs writes them into the package.
#include <sdm/bounds.h>
#include <sdm/closest_points.h>
#include <sdm/doubts.h>
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/match.h>
#include <sdm/proximity_query.h>
#include <sdm/rays.h>
#include <sdm/sampling_bound.h>
#include <sdm/statistics.h>
#include <sdm/summary.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "module/all_measures.h"
#include "module/options.h"
#include "module/points.h"
#include "module/reports.h"
#include "module/result.h"

namespace sdm::js {
namespace {

using Words = std::vector<std::string>;

template <Worded Enum>
Words words_of() {
  return {kWords<Enum>.begin(), kWords<Enum>.end()};
}

const std::vector<std::pair<std::string, Words>>& enumerations() {
  static const std::vector<std::pair<std::string, Words>> all{
      {"SignMethod", words_of<SignMethod>()},
      {"AtlasKind", words_of<AtlasKind>()},
      {"MatchMethod", words_of<MatchMethod>()},
      {"MapMeasure", words_of<MapMeasure>()},
      {"ThicknessMethod", words_of<ThicknessMethod>()},
      {"AttributeDomain", words_of<AttributeDomain>()},
      {"Certainty", words_of<Certainty>()},
      {"Colormap", words_of<Colormap>()},
      {"UpAxis", words_of<UpAxis>()},
      {"DistanceKind", words_of<DistanceKind>()},
      {"Verdict", words_of<Verdict>()},
      {"VerdictReason", words_of<VerdictReason>()},
      {"DecisionRule", words_of<DecisionRule>()},
      {"DoubtReason", words_of<DoubtReason>()}};
  return all;
}

std::string type_of(const Words& of) {
  for (const auto& [name, words] : enumerations())
    if (words == of) return name;
  return "string";
}

std::string type_of(const OptionInfo& option) {
  static const std::map<std::string_view, const char*> kTypes{
      {"flag", "boolean"},
      {"number", "number"},
      {"integer", "number"},
      {"numbers", "readonly number[]"},
      {"text", "string"},
      {"interval", "readonly [least: number, largest: number]"},
      {"tolerance", "number | string | readonly [least: number, largest: number]"},
      {"point", "readonly [x: number, y: number, z: number]"},
      {"direction", "'normal' | readonly [x: number, y: number, z: number]"}};
  return option.type == "word" ? type_of(option.words) : kTypes.at(option.type);
}

/// Of a field, as js/src/results.ts reads it.
template <class Value>
std::string type_of() {
  if constexpr (Worded<Value>) {
    return type_of(words_of<Value>());
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return "number";
  } else if constexpr (requires(Value value) { value.has_value(); }) {
    return type_of<typename Value::value_type>() + " | null";
  } else {
    std::string text = "[";
    for (std::size_t i = 0; i < Value{}.size(); ++i)
      text += (i == 0 ? "" : ", ") + type_of<typename Value::value_type>();
    return text + "]";
  }
}

std::string comment_of(const OptionInfo& option) {
  std::string text = option.text;
  const bool limited = option.range.least > OptionRange{}.least || option.range.most < OptionRange{}.most;
  if (limited && (option.type == "number" || option.type == "integer"))
    text += " Must be " + needed(option) + (option.unit == "length" ? ", in units of the meshes." : ".");
  if (!option.default_value.empty())
    text += " Default: " + (option.default_value == "inf" ? "Infinity" : option.default_value) + ".";
  return text;
}

template <class... Structs>
std::string options_interface(const char* name) {
  std::string text = std::string("export interface ") + name + " {\n";
  for (const OptionInfo& option : options_of<Structs...>())
    text += "  /** " + comment_of(option) + " */\n  " + spelled(option.name, Spelling::camel_case) +
            "?: " + type_of(option) + " | undefined;\n";
  return text + "}\n";
}

template <class Struct>
std::string results_interface(const char* name) {
  std::string text = std::string("export interface ") + name + " {\n";
  for_each_field<Struct>([&](const auto& field) {
    text += std::string("  /** ") + field.text + " */\n  " + spelled(field.name, Spelling::camel_case) +
            ": " + type_of<std::remove_reference_t<decltype(std::declval<Struct>().*field.member)>>() + ";\n";
  });
  return text + "}\n";
}

}  // namespace

SDM_EXPORT(sdm_declared_types) Result* declared_types() {
  return guarded([](Result& result) {
    std::string text = "// Made of the declarations of C++ by js/declared_types.mjs.\n";
    for (const auto& [name, words] : enumerations()) {
      text += "export type " + name + " =";
      for (const std::string& word : words) text += " | '" + word + "'";
      text += ";\n";
    }
    text += options_interface<AtlasOptions, PrecisionOptions>("AtlasOptions");
    text += options_interface<MeasureChoice>("MeasureChoice");
    text += options_interface<MapOptions, AlongOptions>("MapOptions");
    text += options_interface<ExclusionRule, SelfProximityOptions>("SelfOptions");
    text += options_interface<ThicknessOptions>("ThicknessOptions");
    text += options_interface<ClosestPointOptions>("ClosestPointOptions");
    text += options_interface<SignedDistanceOptions>("SignedDistanceOptions");
    text += options_interface<HausdorffOptions>("HausdorffOptions");
    text += options_interface<MatchOptions>("MatchOptions");
    text += options_interface<ProximityOptions>("ProximityOptions");
    text += options_interface<Ray>("RayOptions");
    text += options_interface<AttributeArray, TransferOptions>("TransferOptions");
    text += options_interface<SummaryOptions, MapLimit>("SummaryOptions");
    text += options_interface<PageOptions>("PageOptions");
    text += results_interface<DistanceStatistics>("DistanceStatistics");
    text += results_interface<BoundedLength>("BoundedLength");
    text += results_interface<MatchCounts>("MatchCounts");
    result.put_text("text", std::move(text));
  });
}

}  // namespace sdm::js

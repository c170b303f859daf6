#include "options.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/points.h>
#include <sdm/proximity_query.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <map>
#include <utility>

#include "arrays.h"

namespace sdm::python {
namespace {

constexpr auto kSpelling = Spelling::field;

std::string repr_of(nb::handle value) {
  constexpr std::size_t kMost = 60;
  const std::string text = nb::repr(value).c_str();
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

[[noreturn]] void refuse_type(const OptionInfo& option, nb::handle value) {
  throw nb::type_error(refused(option, repr_of(value), kSpelling).c_str());
}

bool is_number(nb::handle value) {
  return !PyBool_Check(value.ptr()) && PyNumber_Check(value.ptr()) != 0 && !nb::isinstance<nb::str>(value);
}

/// Numbers of a sequence or an array; nothing if it has something else.
std::optional<std::vector<double>> numbers_of(nb::handle value) {
  if (PySequence_Check(value.ptr()) == 0 || nb::isinstance<nb::str>(value)) return std::nullopt;
  std::vector<double> numbers;
  for (std::size_t k = 0; k < nb::len(value); ++k) {
    const nb::object number = value[k];
    if (!is_number(number)) return std::nullopt;
    numbers.push_back(real_of(number));
  }
  return numbers;
}

/// Several numbers, as one text. Throws TypeError for something else.
std::string numbers_text(const OptionInfo& option, nb::handle value, const char* separator) {
  const std::optional<std::vector<double>> numbers = numbers_of(value);
  if (!numbers) refuse_type(option, value);
  std::string text;
  for (const double number : *numbers)
    text.append(text.empty() ? "" : separator).append(sdm::text_of(number));
  return text;
}

/// Words with commas between them. Throws TypeError for something else.
std::string texts_text(const OptionInfo& option, nb::handle value) {
  std::string text;
  if (nb::isinstance<nb::str>(value) || PySequence_Check(value.ptr()) == 0) refuse_type(option, value);
  for (std::size_t k = 0; k < nb::len(value); ++k) {
    const nb::object word = value[k];
    if (!nb::isinstance<nb::str>(word)) refuse_type(option, value);
    text.append(k == 0 ? "" : ",").append(nb::cast<std::string>(word));
  }
  return text;
}

std::string integer_text(const OptionInfo& option, nb::handle value) {
  const nb::object index = nb::steal(is_number(value) ? PyNumber_Index(value.ptr()) : nullptr);
  if (!index.is_valid()) {
    PyErr_Clear();
    refuse_type(option, value);
  }
  return nb::str(index).c_str();
}

std::string direction_text(const OptionInfo& option, nb::handle value) {
  if (nb::isinstance<nb::str>(value)) return nb::cast<std::string>(value);
  const std::optional<std::vector<double>> numbers = numbers_of(value);
  if (!numbers) refuse(option, value);
  return sdm::text_of(*numbers);
}

std::string annotation_of(const OptionInfo& option) {
  std::string text = option.type;
  if (option.type == "number") text = "float";
  if (option.type == "integer") text = "int";
  if (option.type == "flag") text = "bool";
  if (option.type == "direction") text = "str | tuple[float, float, float]";
  if (option.type == "text" || option.type == "motions") text = "str";
  if (option.type == "texts") text = "collections.abc.Sequence[str]";
  if (option.type == "numbers" || option.type == "point") text = "object";
  if (option.type == "interval") text = "tuple[float, float]";
  if (option.type == "tolerance") text = "float | tuple[float, float]";
  if (option.type == "word") {
    text = "typing.Literal[";
    for (const std::string& word : option.words) text += (text.ends_with('[') ? "'" : ", '") + word + "'";
    text += "]";
  }
  if (option.name == "resolution") text += " | tuple[int, int]";  // texels per row, and rows
  return text + " | None";
}

nb::object default_of(const OptionInfo& option) {
  const std::string& text = option.default_value;
  if (option.type == "text" && !option.optional) return nb::str(text.c_str());
  if (option.type == "numbers" || option.type == "point") {
    std::vector<double> numbers;
    (void)read_numbers(text, {}, 0, numbers);
    return nb::tuple(nb::cast(numbers));
  }
  if (text.empty()) return nb::none();
  if (option.type == "flag") return nb::bool_(text == "true");
  if (option.type == "word" || option.type == "motions") return nb::str(text.c_str());
  const nb::object number = nb::float_(nb::str(text.c_str()));
  return option.type == "integer" ? nb::object(nb::int_(number)) : number;
}

std::string paragraph_of(const OptionInfo& option) {
  std::string text = option.name + ": " + option.text;
  const bool limited = option.range.least > OptionRange{}.least || option.range.most < OptionRange{}.most;
  const bool is_number = option.type == "number" || option.type == "integer" || option.type == "numbers";
  if (is_number && limited)
    text += " Must be " + needed(option) + (option.unit == "length" ? ", in units of the meshes." : ".");
  if (option.name == "resolution") text += " With atlas='uv' also two, the texels per row and the rows.";
  return text;
}

template <class... Structs>
CallOptions call_of(std::vector<std::string> others) {
  return {options_of<Structs...>(), std::move(others), [](const nb::dict& given) {
            for (const std::size_t side : {0, 1}) {
              const nb::dict square = with_side(given, side);
              const auto check = [&]<class Struct>(Struct options) { set_options(square, options); };
              (check(Structs{}), ...);
            }
          }};
}

const std::map<std::string, CallOptions>& all_calls() {
  static const std::map<std::string, CallOptions> calls{
      {"Surface", call_of<AtlasOptions, PrecisionOptions>({"mesh", "faces", "progress"})},
      {"map", call_of<AtlasOptions, PrecisionOptions, MapOptions, AlongOptions>(
                  {"transform", "engine", "progress"})},
      {"self_map",
       call_of<AtlasOptions, PrecisionOptions, ExclusionRule, SelfProximityOptions>({"rest", "progress"})},
      {"thickness", call_of<AtlasOptions, ThicknessOptions>({"progress"})},
      {"match", call_of<AtlasOptions, MatchOptions>({"normals", "engine", "progress"})},
      {"measure_points",
       call_of<MapOptions, AlongOptions, ColorChoice, PointDistancesOptions, TextDialect>(
           {"transform", "engine", "progress", "tolerance_table", "names", "island_points"})},
      {"read_points", call_of<TextDialect>({})},
      {"save", call_of<PictureOptions>({"progress"})},
      {"report", call_of<SummaryOptions>({"progress"})},
      {"ambient_occlusion", call_of<AmbientOcclusionOptions>({"fill", "progress"})},
      {"TexelMatches.thickness", call_of<ThicknessOptions>({"fill", "progress"})},
      {"align", call_of<AlignOptions, AlignFreedoms>({"pose", "on_faces", "on_boxes", "progress"})},
      {"align_points",
       call_of<AlignOptions, AlignFreedoms>({"normals", "pose", "on_faces", "on_boxes", "progress"})},
      {"simplify", call_of<LevelsOptions>({"progress"})},
      {"weld", call_of<WeldOptions>({})},
      {"read", call_of<TessellationOptions>({})},
      {"bake", call_of<BakeRequest>({"vertex_colors", "face_colors", "texture", "uvs", "progress"})},
      {"surface_metrics", call_of<MetricsOptions>({"progress"})},
      {"PoseQuery", call_of<PoseQueryOptions>({"shape", "obstacles"})},
      {"MultiBodyQuery.time_of_contact", call_of<TimeOfContactOptions>({"starts", "ends", "tolerance"})},
      {"distance_field", call_of<FieldOptions>({"spacing", "shape", "bounds", "margin", "progress"})},
      {"hausdorff", call_of<HausdorffOptions>({"one_sided", "progress"})},
      {"ProximityQuery", call_of<ProximityOptions>({"o1", "o2"})},
      {"MultiBodyQuery", call_of<ProximityOptions>({"bodies"})},
      {"SelfProximityQuery", call_of<ExclusionRule, SelfProximityOptions>({"rest", "progress"})}};
  return calls;
}

}  // namespace

const CallOptions& call_options(const std::string& call) {
  return all_calls().at(call);
}

nb::dict with_side(const nb::dict& given, std::size_t side) {
  constexpr const char* kResolution = "resolution";
  if (!given.contains(kResolution)) return given;
  const nb::object sides = given[kResolution];
  if (!nb::isinstance<nb::tuple>(sides) && !nb::isinstance<nb::list>(sides)) return given;
  if (nb::len(sides) != 2) throw Error("resolution must be an integer, or two: texels per row, and rows");
  nb::dict square;
  for (const auto& [name, value] : given) square[name] = value;
  square[kResolution] = sides[side];
  return square;
}

void check_keywords(const std::string& call, const nb::dict& keywords) {
  const auto& [options, others, check_values] = call_options(call);
  std::vector<std::string> known = others;
  for (const OptionInfo& option : options) known.push_back(option.name);
  std::vector<GivenOption> given;
  for (const auto& [key, value] : keywords) {
    const auto name = nb::cast<std::string>(key);
    if (std::ranges::find(known, name) == known.end())
      throw nb::type_error((call + "() has an " + unknown_name("option", name, known)).c_str());
    if (!value.is_none())
      given.push_back({name, nb::isinstance<nb::str>(value) ? nb::cast<std::string>(value) : ""});
  }
  check_values(keywords);
  check_exclusions(options, given, kSpelling);
}

std::string option_signature(const std::string& call, const std::vector<std::string>& without) {
  std::string text;
  for (const OptionInfo& option : call_options(call).options) {
    if (std::ranges::find(without, option.name) != without.end()) continue;
    const nb::object value = default_of(option);
    const std::string shown = option.default_value == "inf" ? "..." : nb::repr(value).c_str();
    text += option.name + ": " + annotation_of(option) + " = " + shown + ", ";
  }
  return text;
}

std::string option_documentation(const std::string& call, const std::vector<std::string>& without) {
  std::string text;
  for (const OptionInfo& option : call_options(call).options) {
    if (std::ranges::find(without, option.name) != without.end()) continue;
    if (!text.empty()) text += '\n';
    text += paragraph_of(option);
  }
  return text;
}

std::string text_of(const OptionInfo& option, nb::handle value) {
  if (option.type == "word") {
    if (!nb::isinstance<nb::str>(value)) refuse_type(option, value);
    return nb::cast<std::string>(value);
  }
  if (option.type == "flag") {
    if (!PyBool_Check(value.ptr())) refuse_type(option, value);
    return nb::cast<bool>(value) ? "true" : "false";
  }
  if (option.type == "text" || option.type == "motions") {
    if (!nb::isinstance<nb::str>(value)) refuse_type(option, value);
    return nb::cast<std::string>(value);
  }
  if (option.type == "texts") return texts_text(option, value);
  if (option.type == "direction") return direction_text(option, value);
  if (option.type == "integer") return integer_text(option, value);
  if (option.type == "interval" || option.type == "point") return numbers_text(option, value, ",");
  if (is_number(value)) return sdm::text_of(real_of(value));
  if (option.type == "numbers") return numbers_text(option, value, ",");
  if (option.type == "tolerance") {
    const std::string text = numbers_text(option, value, ":");
    if (text.find(':') == std::string::npos) refuse(option, value);  // not one number in a sequence
    return text;
  }
  refuse_type(option, value);
}

void refuse(const OptionInfo& option, nb::handle value) {
  throw Error(refused(option, repr_of(value), kSpelling));
}

void bind_options(nb::module_& module) {
  module.def(
      "options",
      [](const std::string& call) {
        nb::list all;
        for (const OptionInfo& option : call_options(call).options)
          all.append(nb::make_tuple(option.name, annotation_of(option), default_of(option)));
        return all;
      },
      nb::arg("call"), nb::sig("def options(call: str) -> list[tuple[str, str, object]]"));
  module.def(
      "option_table",
      [](const std::string& call) {
        nb::list rows;
        for (const OptionInfo& option : call_options(call).options) {
          std::string excluded;
          for (const ExcludedOption& other : option.excludes)
            excluded.append(excluded.empty() ? "" : ", ").append(other.name);
          rows.append(nb::make_tuple(option.name, spelled(option.name, Spelling::dashed),
                                     spelled(option.name, Spelling::camel_case), needed(option), option.unit,
                                     option.default_value, excluded, option.since, option.text));
        }
        return rows;
      },
      nb::arg("call"), nb::sig("def option_table(call: str) -> list[tuple[str, ...]]"));
  module.def(
      "option_calls",
      [] {
        nb::list names;
        for (const auto& [name, options] : all_calls()) names.append(name);
        return names;
      },
      nb::sig("def option_calls() -> list[str]"));
  module.def("option_documentation", &option_documentation, nb::arg("call"),
             nb::arg("without") = std::vector<std::string>());
  module.def("option_signature", &option_signature, nb::arg("call"),
             nb::arg("without") = std::vector<std::string>());
  module.def("check_keywords", &check_keywords, nb::arg("call"), nb::arg("given"),
             nb::sig("def check_keywords(call: str, given: dict[str, object]) -> None"));
}

}  // namespace sdm::python

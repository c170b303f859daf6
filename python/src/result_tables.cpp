// The declared fields of results, for the documentation.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <sdm/doubts.h>
#include <sdm/io.h>
#include <sdm/map_files.h>
#include <sdm/mesh_edit.h>
#include <sdm/metrics.h>
#include <sdm/options.h>
#include <sdm/points.h>
#include <sdm/sdm.h>
#include <sdm/simplify.h>

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "objects.h"

namespace sdm::python {
namespace {

template <class Value>
constexpr bool kIsOptional = false;
template <class Value>
constexpr bool kIsOptional<std::optional<Value>> = true;
template <class Value>
constexpr bool kIsList = false;
template <class Value>
constexpr bool kIsList<std::vector<Value>> = true;
template <class Value, std::size_t count>
constexpr bool kIsList<std::array<Value, count>> = true;

/// What a value is, in words.
template <class Value>
std::string kind_of() {
  if constexpr (std::is_same_v<Value, bool>) {
    return "true or false";
  } else if constexpr (std::is_integral_v<Value>) {
    return "a whole number";
  } else if constexpr (std::is_floating_point_v<Value>) {
    return "a number";
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return "a text";
  } else if constexpr (std::is_same_v<Value, Vec3>) {
    return "three coordinates";
  } else if constexpr (std::is_same_v<Value, Tolerance>) {
    return "two numbers";
  } else if constexpr (std::is_same_v<Value, Transform>) {
    return "a matrix";
  } else if constexpr (Worded<Value>) {
    std::string words;
    for (const char* word : kWords<Value>) words += (words.empty() ? "'" : ", '") + std::string(word) + "'";
    return "one of " + words;
  } else if constexpr (kIsOptional<Value>) {
    return kind_of<typename Value::value_type>() + ", or nothing";
  } else if constexpr (kIsList<Value>) {
    return "several: " + kind_of<typename Value::value_type>() + " each";
  } else {
    static_assert(Declared<Value>);
    return "a result with fields of its own";
  }
}

/// name, name in JavaScript, what it is, sentence
using Row = std::tuple<std::string, std::string, std::string, std::string>;

template <class Struct>
std::tuple<std::string, std::vector<Row>> table_of(const char* name) {
  std::vector<Row> rows;
  for_each_field<Struct>([&](const auto& field) {
    using Value = std::remove_cvref_t<decltype(std::declval<const Struct&>().*field.member)>;
    rows.emplace_back(field.name, spelled(field.name, Spelling::camel_case),
                      kind_of<Value>() + (field.index ? ", or nothing" : ""), field.text);
  });
  return {name, std::move(rows)};
}

}  // namespace

void bind_result_tables(nb::module_& module) {
  module.def(
      "result_tables",
      [] {
        return std::vector{table_of<DistanceStatistics>("DistanceStatistics"),
                           table_of<BoundedNumber>("BoundedNumber"),
                           table_of<BoundedLength>("BoundedLength"),
                           table_of<HausdorffDistance>("HausdorffDistance"),
                           table_of<ToleranceVerdict>("ToleranceVerdict"),
                           table_of<ToleranceShares>("ToleranceShares"),
                           table_of<NextSteps>("NextSteps"),
                           table_of<ToleranceProof>("ToleranceProof"),
                           table_of<PlaceDecision>("PlaceDecision"),
                           table_of<ToleranceWitness>("ToleranceWitness"),
                           table_of<Evidence>("Evidence"),
                           table_of<GroupVerdicts>("GroupVerdicts"),
                           table_of<GroupVerdict>("GroupVerdict"),
                           table_of<PointsWithoutGroup>("PointsWithoutGroup"),
                           table_of<Places>("Places"),
                           table_of<PlaceTotals>("PlaceTotals"),
                           table_of<Place>("Place"),
                           table_of<Doubt>("Doubt"),
                           table_of<DistanceHistogram>("DistanceHistogram"),
                           table_of<DistanceBand>("DistanceBand"),
                           table_of<Coverage>("Coverage"),
                           table_of<CoverageMap>("CoverageMap"),
                           table_of<SignUsed>("SignUsed"),
                           table_of<PointDistances>("PointDistances"),
                           table_of<PointExtreme>("PointExtreme"),
                           table_of<PointIslands>("PointIslands"),
                           table_of<TextDialect>("TextDialect"),
                           table_of<Alignment>("Alignment"),
                           table_of<AlignMotion>("AlignMotion"),
                           table_of<AlignResiduals>("AlignResiduals"),
                           table_of<GroupResiduals>("GroupResiduals"),
                           table_of<DegreeOfFreedom>("DegreeOfFreedom"),
                           table_of<MirroredFit>("MirroredFit"),
                           table_of<OtherScale>("OtherScale"),
                           table_of<DirectedMetrics>("DirectedMetrics"),
                           table_of<SeparatingTranslation>("SeparatingTranslation"),
                           table_of<Contact>("Contact"),
                           table_of<TimeOfContact>("TimeOfContact"),
                           table_of<Simplified>("Simplified"),
                           table_of<WeldReport>("WeldReport"),
                           table_of<IslandReport>("IslandReport"),
                           table_of<MeshInfo>("MeshInfo"),
                           table_of<Box>("Box"),
                           table_of<Tessellation>("Tessellation"),
                           table_of<DistanceField>("DistanceField"),
                           table_of<Grid>("Grid"),
                           table_of<ReportTimes>("ReportTimes"),
                           table_of<GlReport>("GlReport"),
                           table_of<GlDevice>("GlDevice")};
      },
      nb::sig("def result_tables() -> list[tuple[str, list[tuple[str, str, str, str]]]]"));
}

}  // namespace sdm::python

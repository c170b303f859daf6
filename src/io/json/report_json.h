// Results as objects of JSON, made in one place for all outputs: sdm/report.h has their text, and the command
// adds what only it knows. NaN and infinity are null once they are printed. Exported, as the command has
// these functions from a shared library, too.
#pragma once

#include <sdm/api.h>
#include <sdm/bounds.h>
#include <sdm/doubts.h>
#include <sdm/group_verdicts.h>
#include <sdm/hausdorff.h>
#include <sdm/islands.h>
#include <sdm/metrics.h>
#include <sdm/multi_body_query.h>
#include <sdm/names.h>
#include <sdm/points.h>
#include <sdm/proximity_query.h>
#include <sdm/report.h>

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

namespace sdm {

/// An optional value; null if there is none.
template <class Value>
[[nodiscard]] nlohmann::ordered_json optional_json(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

/// The declared fields of a result (sdm/names.h), by their names but for `other_keys`. Enumerators are words;
/// how certain a number is, is its `kind`.
template <class Struct>
[[nodiscard]] nlohmann::ordered_json fields_json(
    const Struct& of, std::initializer_list<std::pair<std::string_view, std::string_view>> other_keys = {}) {
  auto json = nlohmann::ordered_json::object();
  for_each_field<Struct>([&](const auto& field) {
    using Value = std::remove_cvref_t<decltype(of.*field.member)>;
    std::string_view key = field.name;
    if constexpr (std::is_same_v<Value, Certainty>) key = "kind";
    for (const auto& [name, other] : other_keys)
      if (key == name) key = other;
    nlohmann::ordered_json& value = json[std::string(key)];
    if constexpr (Worded<Value>)
      value = name_of(of.*field.member);
    else if constexpr (requires { (of.*field.member).has_value(); })
      value = optional_json(of.*field.member);
    else
      value = of.*field.member;
  });
  return json;
}

[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const Tessellation& tessellation);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const ReportedMesh& mesh);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const DistanceStatistics& statistics);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const Summary& summary);
/// report.json of a map.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const MapReport& report, const Surface& surface,
                                                     const Summary& summary);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(std::span<const Doubt> doubts);
/// The doubts of to_json().
[[nodiscard]] SDM_API std::vector<Doubt> doubts_from(const nlohmann::ordered_json& json);
/// `of_points`: of a cloud, whose groups have points in place of areas.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const GroupVerdicts& verdicts, bool of_points);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const IslandReport& islands);
/// `points`: the number of points of the cloud.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const PointIslands& islands, std::uint64_t points);

/// `facing`: whether faces may lack a match.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const HausdorffDistance& distance, bool facing = false);
/// An estimate has the confidence of its bounds.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const BoundedNumber& number,
                                                     std::optional<double> confidence);
/// `options`, `confidence`: those of the metrics.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const DirectedMetrics& metrics,
                                                     const MetricsOptions& options, double confidence);

/// Whether two bodies collide.
[[nodiscard]] SDM_API nlohmann::ordered_json collision_json(bool colliding);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const Contact& contact);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(std::span<const PairContacts> pairs);

}  // namespace sdm

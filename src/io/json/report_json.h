// Results as objects of JSON, made in one place for all outputs: sdm/map_files.h has their text, and the
// command adds what only it knows. NaN and infinity are null once they are printed. Exported, as the command
// has these functions from a shared library, too.
#pragma once

#include <sdm/align.h>
#include <sdm/bounds.h>
#include <sdm/doubts.h>
#include <sdm/gl.h>
#include <sdm/hausdorff.h>
#include <sdm/map_files.h>
#include <sdm/mesh_edit.h>
#include <sdm/metrics.h>
#include <sdm/multi_body_query.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/points.h>
#include <sdm/proximity_query.h>
#include <sdm/simplify.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>
#include <sdm/verdict.h>
#include <sdm/volume.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace sdm {

/// Keys in place of the names of fields; an empty one leaves the field out.
using OtherKeys = std::vector<std::pair<std::string_view, std::string_view>>;

template <Declared Struct>
[[nodiscard]] nlohmann::ordered_json fields_json(const Struct& of, const OtherKeys& other_keys = {});

/// A value, an array or a result that declares its fields. An enumerator is its word, an optional value
/// without one null, and a transform the rows of its matrix.
template <class Value>
[[nodiscard]] nlohmann::ordered_json value_json(const Value& value, const OtherKeys& other_keys = {}) {
  if constexpr (Worded<Value>) {
    return name_of(value);
  } else if constexpr (Declared<Value>) {
    return fields_json(value, other_keys);
  } else if constexpr (std::is_same_v<Value, Transform>) {
    return value.rows;
  } else if constexpr (requires { value.has_value(); }) {
    return value ? value_json(*value, other_keys) : nlohmann::ordered_json();
  } else if constexpr (requires { requires Declared<typename Value::value_type>; }) {
    auto array = nlohmann::ordered_json::array();
    for (const auto& element : value) array.push_back(fields_json(element, other_keys));
    return array;
  } else {
    return value;
  }
}

/// The declared fields of a result (sdm/names.h) and of the results that it holds, by their names but for
/// `other_keys`. How certain a number is, is its `kind`; the limits of a tolerance are `lower` and `upper`.
template <Declared Struct>
nlohmann::ordered_json fields_json(const Struct& of, const OtherKeys& other_keys) {
  auto json = nlohmann::ordered_json::object();
  for_each_field<Struct>([&](const auto& field) {
    const auto& value = of.*field.member;
    using Value = std::remove_cvref_t<decltype(value)>;
    std::string_view key = field.name;
    if constexpr (std::is_same_v<Value, Certainty>) key = "kind";
    for (const auto& [name, other] : other_keys)
      if (key == name) key = other;
    if (key.empty()) return;
    if constexpr (std::is_same_v<Value, Tolerance>) {
      json["lower"] = value.lower;
      json["upper"] = value.upper;
    } else {
      json[std::string(key)] = value_json(value, other_keys);
    }
    if (is_no_index(field, value)) json[std::string(key)] = nullptr;
  });
  return json;
}

/// Adds a key behind another one, whose objects are in the order of the declared fields.
inline void insert_after(nlohmann::ordered_json& json, std::string_view before, const char* key,
                         const nlohmann::ordered_json& value) {
  auto result = nlohmann::ordered_json::object();
  for (const auto& [name, of] : json.items()) {
    result[name] = of;
    if (name == before) result[key] = value;
  }
  json = std::move(result);
}

/// Options by name in the types that they are declared with; null: absent, or no limit.
[[nodiscard]] SDM_API nlohmann::ordered_json settings_json(const std::vector<GivenOption>& settings);
/// All declared options of structs.
template <class... Structs>
[[nodiscard]] nlohmann::ordered_json settings_json(const Structs&... options) {
  auto json = nlohmann::ordered_json::object();
  (json.update(settings_json(settings_of(options))), ...);
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
/// All measures by their names, as `metrics`, and those of each direction, as `o1_to_o2` and `o2_to_o1`.
/// `options`: those of the metrics.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const SurfaceMetrics& metrics,
                                                     const MetricsOptions& options);

/// Whether two bodies collide.
[[nodiscard]] SDM_API nlohmann::ordered_json collision_json(bool colliding);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const Contact& contact);
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(std::span<const PairContacts> pairs);
/// `penetration_depth`: null if neither body is a solid.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const PairSeparation& pair,
                                                     const std::optional<BoundedLength>& penetration_depth);
/// All results of the query, which are computed if necessary.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(ProximityQuery& query);
/// Why there is no penetration depth, as neither body is a solid.
[[nodiscard]] SDM_API std::string no_depth_text(const ProximityQuery& query);
/// The number of patches of the contacts of two bodies.
[[nodiscard]] SDM_API std::size_t patch_count(std::span<const Contact> contacts);

/// The pose, what it was found from, and the sizes of the motion; without the options of the call.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const Alignment& alignment);
/// A mesh with fewer triangles, by its numbers.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const Simplified& simplified);
/// The numbers of a field, without its points.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const DistanceField& field);
/// The counters of the gl engine.
[[nodiscard]] SDM_API nlohmann::ordered_json to_json(const GlReport& report);

}  // namespace sdm

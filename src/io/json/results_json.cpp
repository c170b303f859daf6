// The results of queries, without a report around them.
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/json/report_json.h"

namespace sdm {

using Json = nlohmann::ordered_json;

Json to_json(const IslandReport& islands) {
  return fields_json(islands, {{"faces", "triangles"}});
}

Json to_json(const PointIslands& islands, std::uint64_t points) {
  Json json = fields_json(islands, {{"apart", ""}});
  insert_after(json, "points", "point_fraction",
               static_cast<double>(islands.points) / static_cast<double>(points));
  return json;
}

Json to_json(const HausdorffDistance& distance, bool facing) {
  Json json = fields_json(distance.distance);
  OtherKeys keys{{"distance", ""}};
  if (!facing) keys.insert(keys.end(), {{"faces_without_match", ""}, {"area_without_match", ""}});
  json.update(fields_json(distance, keys));
  return json;
}

Json to_json(const BoundedNumber& number, std::optional<double> confidence) {
  Json json = fields_json(number);
  if (number.certainty == Certainty::estimate && confidence) json["confidence"] = *confidence;
  return json;
}

namespace {

Json to_json(const DirectedMetrics& metrics, const MetricsOptions& options, double confidence) {
  // One number for each that was asked for, with that.
  const auto list = [&](const std::vector<BoundedNumber>& numbers, const char* of,
                        const std::vector<double>& asked) {
    Json all = Json::array();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      all.push_back({{of, asked[i]}});
      all.back().update(to_json(numbers[i], confidence));
    }
    return all;
  };
  Json json;
  for_each_field<DirectedMetrics>([&](const auto& field) {
    const auto& value = metrics.*field.member;
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, BoundedNumber>)
      json[field.name] = to_json(value, confidence);
    else if constexpr (std::is_arithmetic_v<Value>)
      json[field.name] = value;
  });
  if (!options.estimate) json.erase("points");
  json["percentiles"] = list(metrics.percentiles, "percent", options.percentiles);
  json["within"] = list(metrics.within, "tolerance", options.tolerances);
  return json;
}

}  // namespace

Json to_json(const SurfaceMetrics& metrics, const MetricsOptions& options) {
  Json json;
  for (const NamedMetric& m : named_metrics(metrics, options))
    json["metrics"][m.name] = to_json(m.number, m.confidence);
  json["o1_to_o2"] = to_json(metrics.from[0], options, metrics.confidence);
  json["o2_to_o1"] = to_json(metrics.from[1], options, metrics.confidence);
  return json;
}

Json collision_json(bool colliding) {
  return {{"value", colliding}, {"kind", name_of(Certainty::exact)}};
}

Json to_json(const Contact& contact) {
  Json json = fields_json(contact);
  json["faces"] = {contact.on[0].face, contact.on[1].face};
  json["barycentric"] = {contact.on[0].barycentric, contact.on[1].barycentric};
  return json;
}

Json to_json(std::span<const PairContacts> pairs) {
  Json contacts = Json::array();
  for (const PairContacts& pair : pairs)
    for (const Contact& contact : pair.contacts) {
      Json json{{"first", pair.first}, {"second", pair.second}};
      json.update(to_json(contact));
      contacts.push_back(std::move(json));
    }
  return contacts;
}

Json to_json(const PairSeparation& pair, const std::optional<BoundedLength>& penetration_depth) {
  Json json = fields_json(pair, {{"parts", ""}});
  json["colliding"] = collision_json(pair.colliding);
  json["penetration_depth"] = value_json(penetration_depth);
  return json;
}

Json to_json(ProximityQuery& query) {
  Json json;
  json["separation"] = fields_json(query.separation());
  json["colliding"] = collision_json(query.colliding());
  json["penetration_depth"] = value_json(query.penetration_depth());
  if (!query.penetration_depth()) json["no_penetration_depth"] = no_depth_text(query);
  json["separating_translation"] = fields_json(query.separating_translation());
  json["contacts"] = Json::array();
  for (const Contact& contact : query.contacts()) json["contacts"].push_back(to_json(contact));
  json["patches"] = patch_count(query.contacts());
  return json;
}

std::string no_depth_text(const ProximityQuery& query) {
  const auto reason = [&](int body) {
    std::string text = choose_sign(query.sites(body), SignMethod::automatic).reason;
    if (const std::size_t at = text.find("O2"); body == 0 && at != std::string::npos) text[at + 1] = '1';
    return text;
  };
  return reason(0) + "; " + reason(1);
}

std::size_t patch_count(std::span<const Contact> contacts) {
  return contacts.empty() ? 0 : contacts.back().patch + 1;
}

Json to_json(const Alignment& alignment) {
  Json json = fields_json(alignment, {{"transform", "matrix"}, {"freedoms", "degrees_of_freedom"}});
  insert_after(json, "matrix", "order", "row-major, for column vectors");
  json.update(fields_json(motion_of(alignment)));
  json["residuals_kind"] = name_of(Certainty::estimate);
  return json;
}

Json to_json(const Simplified& simplified) {
  Json json{{"vertices", simplified.mesh.positions.size()}, {"triangles", simplified.mesh.triangles.size()}};
  json.update(fields_json(simplified));
  json["estimate"] = {
      {"value", simplified.estimate}, {"kind", name_of(Certainty::estimate)}, {"of", "meshoptimizer"}};
  return json;
}

Json to_json(const DistanceField& field) {
  const auto [min, max] = distance_range(field);
  Json json = fields_json(field);
  insert_after(json, "sign", "distance", {{"min", min}, {"max", max}});  // null: no point has a value
  json["accuracy_kind"] = name_of(Certainty::bounded);
  return json;
}

Json to_json(const GlReport& report) {
  Json json = fields_json(report);
  insert_after(json, "texels", "overdraw", report.overdraw());
  for (const auto& [name, count] : report.counts) json[std::string(name)] = count;
  for (const auto& [name, ms] : report.time_ms)
    json["time_ms"][std::string(name)] = std::round(1000 * ms) / 1000;  // to microseconds
  return json;
}

}  // namespace sdm

#include "io/json/report_json.h"

#include <sdm/version.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/parse_number.h"

namespace sdm {

using Json = nlohmann::ordered_json;

namespace {

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::ignore);
}

Json to_json(const Surface& surface) {
  return {{"kind", name_of(surface.atlas_kind())},
          {"resolution", surface.resolution()},
          {"rows", surface.rows()},
          {"charts", surface.chart_count()},
          {"texels", surface.owned_texels()},
          {"utilisation", surface.utilisation()},
          {"max_stretch", surface.max_stretch()},
          {"gutter", surface.gutter()},
          {"overlapping_texels", surface.overlapping_texels()},
          {"area_fraction_without_texels", area_fraction_without_texels(surface)}};
}

Json to_json(const ColorRange& colors) {
  return {{"map", colors.colormap == Colormap::automatic ? "tolerance" : name_of(colors.colormap)},
          {"range", colors.range},
          {"range_from", colors.chosen ? "option" : "p99_abs"}};
}

Json to_json(const Extreme& extreme) {
  return {{"distance", extreme.distance},
          {"point", extreme.point},
          {"at", extreme.at_vertex ? "vertex" : "texel"}};
}

Json extremes_json(const Summary& summary) {
  if (!summary.extremes) return {{"min", nullptr}, {"max", nullptr}};
  Json json{{"min", to_json(summary.extremes->min)}, {"max", to_json(summary.extremes->max)}};
  if (!summary.of_points) return json;
  for (const auto& [key, index] :
       {std::pair("min", summary.extreme_points[0]), std::pair("max", summary.extreme_points[1])})
    json[key]["at"] = "point", json[key]["index"] = index;
  return json;
}

/// Keys are those of a surface; a cloud has points in place of texels and areas.
Json to_json(const Place& place, bool of_points) {
  Json json{{"distance", place.distance},
            {"point", place.point},
            {"at", of_points               ? "point"
                   : place.sample == kNone ? "vertex"
                                           : "texel"}};
  if (of_points) json["index"] = place.sample;
  json["triangle"] = place.face == kNone ? Json() : Json(place.face);
  json[of_points ? "points" : "texels"] = place.samples;
  if (!of_points) json["area"] = place.area;
  json[of_points ? "point_fraction" : "area_fraction"] = place.fraction;
  json["kind"] = place.kind.empty() ? Json() : Json(place.kind);
  json["group"] = place.group.empty() ? Json() : Json(place.group);
  json["small"] = place.small;
  json["lower"] = place.limits.lower, json["upper"] = place.limits.upper;
  return json;
}

Json totals_json(const PlaceTotals& totals, bool of_points) {
  Json json{{"count", totals.count}, {of_points ? "points" : "texels", totals.samples}};
  if (!of_points) json["area"] = totals.area;
  json[of_points ? "point_fraction" : "area_fraction"] = totals.fraction;
  return json;
}

Json to_json(const Places& places, bool of_points) {
  Json largest = Json::array();
  for (const Place& place : places.largest) largest.push_back(to_json(place, of_points));
  return {{"kind", "estimate"},
          {"lower", places.limits.lower},
          {"upper", places.limits.upper},
          {"limits_from", places.by_tolerance ? "tolerance" : "p99_abs"},
          {of_points ? "least_point_fraction" : "least_area_fraction", places.least_fraction},
          {"large", totals_json(places.large, of_points)},
          {"small", totals_json(places.small, of_points)},
          {"largest", std::move(largest)}};
}

/// What was proven where the samples did not decide.
Json to_json(const ToleranceProof& proof) {
  Json json{{"witness", nullptr},
            {"undecided_by", optional_json(proof.undecided_by)},
            {"depends_on_signs", proof.depends_on_signs},
            {"faces_without_match", proof.faces_without_match}};
  if (const auto& witness = proof.witness)
    json["witness"] = fields_json(*witness, {{"face", "triangle"}, {"closest_face", "closest_triangle"}});
  return json;
}

Json tolerance_json(const Summary& summary) {
  const CertifiedVerdict& verdict = *summary.tolerance;
  const auto [lo, hi] = verdict.tolerance;
  Json json;
  json["value"] = lo == -hi ? Json(hi) : Json();
  json["lower"] = lo;
  json["upper"] = hi;
  json["verdict"] = name_of(verdict.verdict);
  json["reason"] = name_of(verdict.reason);
  json["text"] = verdict_text(summary);
  if (summary.of_points) {
    json["exceeded_points"] = summary.exceeding_points;
    json["exceeded_point_fraction"] = summary.exceeding_point_fraction;
  } else {
    json["exceeded_area_fraction"] = verdict.exceeded_area_fraction;
    json["area_fractions"] = fields_json(verdict.shares);
  }
  json["within"] = verdict.within;
  json["certified"] = verdict.certified;
  json["margin"] = optional_json(verdict.margin);
  json["nearest_limit"] = verdict.nearest_is_lower ? "lower" : "upper";
  json["proof"] = verdict.proof ? to_json(*verdict.proof) : Json();
  json["by_facing"] = verdict.by_facing ? Json(*verdict.by_facing) : Json();
  return json;
}

Json to_json(const PartTable& table) {
  Json rows = Json::array();
  for (const auto& [name, part, first_face] : table.rows) {
    Json row;
    if (table.kind != "component") row["name"] = name.empty() ? Json() : Json(name);
    row["triangles"] = part.faces;
    row["first_triangle"] = first_face;
    row["bounds"] = {{"lo", part.box.lo}, {"hi", part.box.hi}};
    row["area_fraction"] = part.area_fraction;
    row["distance"] = to_json(part.distance);
    row["texels_with_value"] = part.distance.texels;
    if (part.tolerance) row["tolerance"] = fields_json(*part.tolerance);
    rows.push_back(std::move(row));
  }
  return {{"kind", table.kind}, {"count", table.count}, {"largest", std::move(rows)}};
}

void add(Json& json, const Distribution& distribution) {
  json["histogram"] = nullptr;
  if (const auto& h = distribution.histogram)
    json["histogram"] = {{"lower", h->lower}, {"upper", h->upper}, {"area_fractions", h->area_fractions},
                         {"below", h->below}, {"above", h->above}, {"without_value", h->without_value}};
  json["bands"] = Json::array();
  for (const DistanceBand& band : distribution.bands)  // null: no limit
    json["bands"].push_back(
        {{"lower", band.lower}, {"upper", band.upper}, {"area_fraction", band.area_fraction}});
  json["components"] = to_json(distribution.parts.front());
  json["groups"] = Json::array();
  for (std::size_t i = 1; i < distribution.parts.size(); ++i)
    json["groups"].push_back(to_json(distribution.parts[i]));
}

Json largest_json(const Summary& summary) {
  const LargestDistance& d = summary.hausdorff;
  return {{"lower", optional_json(d.lower)},
          {"upper", optional_json(d.upper)},
          {"kind", d.lower ? "bounded" : "unknown"},
          {"point", optional_json(d.point)}};
}

/// The options of a measure by name, as numbers, flags and words; null: absent, or no limit.
Json settings_json(const std::vector<GivenOption>& settings) {
  Json json = Json::object();
  for (const auto& [name, value] : settings) {
    const std::optional<double> number = core::parse_number(value);
    if (value.empty() || (number && !std::isfinite(*number)))
      json[name] = nullptr;
    else if (value == "true" || value == "false")
      json[name] = value == "true";
    else
      json[name] = number ? Json(*number) : Json(value);
  }
  return json;
}

/// What is measured of a surface and not of points.
void add_surface(Json& json, const Summary& summary) {
  const Evidence& evidence = summary.evidence;
  const bool known = std::isfinite(evidence.accuracy) && !evidence.samples_only;
  json["boundary_texels"] = summary.boundary_texels;
  json["error_bound"] = known ? Json(evidence.error_bound) : Json();
  json["error_bound_kind"] = known ? "bounded" : "unknown";
  json["hausdorff"] = {{"one_sided", largest_json(summary)}};
}

Json to_json(const ReportTimes& t) {
  return {{"import", optional_json(t.import)}, {"atlas", optional_json(t.atlas)},
          {"sites", optional_json(t.sites)},   {"map", optional_json(t.map)},
          {"export", optional_json(t.output)}, {"total", optional_json(t.total)}};
}

/// Null unless points are without a group.
Json reason_json(const PointsWithoutGroup& points) {
  if (!points.any()) return nullptr;
  return name_of(points.without_match > 0 ? VerdictReason::without_match
                                          : VerdictReason::beyond_max_distance);
}

}  // namespace

Json to_json(const Tessellation& t) {
  return {{"format", t.format},
          {"file_unit", t.file_unit.empty() ? Json() : Json(t.file_unit)},
          {"unit", "mm"},
          {"faces", t.faces},
          {"omitted_faces", t.omitted_faces},
          {"deflection", t.deflection},
          {"angle", t.angle},
          {"largest_deviation",
           {{"value", t.largest_deviation}, {"kind", "estimate"}, {"points", t.measured_points}}}};
}

Json to_json(const ReportedMesh& mesh) {
  Json json{{"file", mesh.file},
            {"xxh3", mesh.xxh3.empty() ? Json() : Json(mesh.xxh3)},
            {"transform", mesh.transform},
            {"vertices", mesh.info.vertices},
            {"triangles", mesh.info.triangles},
            {"closed", mesh.info.closed},
            {"degenerate_faces", mesh.info.degenerate_faces},
            {"duplicate_faces", mesh.info.duplicate_faces}};
  if (mesh.weld) json["weld"] = fields_json(*mesh.weld);
  if (mesh.tessellation) json["tessellation"] = to_json(*mesh.tessellation);
  return json;
}

Json to_json(const DistanceStatistics& statistics) {
  Json json{{"kind", "estimate"}};
  for_each_field<DistanceStatistics>([&](const auto& field) {
    const auto value = statistics.*field.member;
    // The numbers of texels are in the report itself.
    if constexpr (std::is_floating_point_v<decltype(value)>) json[field.name] = value;
  });
  return json;
}

Json to_json(const Summary& summary) {
  const DistanceStatistics& d = summary.distance;
  Json json;
  json["units"] = summary.units;
  json["max_distance"] = summary.max_distance;  // null: no limit
  if (summary.colors) json["colors"] = to_json(*summary.colors);
  if (summary.of_itself && !summary.of_thickness) {
    json["distance"] = to_json(d);
    json["texels_with_value"] = d.texels;
    json["texels_without_value"] = summary.beyond_max_distance;
    if (summary.places) json["places"] = to_json(*summary.places, false);
    json["notes"] = summary.notes;
    return json;
  }
  json["measured"] = {{"kind", name_of(summary.measured.kind)}, {"text", summary.measured.text}};
  json["measured"]["settings"] = settings_json(summary.measured.settings);
  json["sign"] = fields_json(summary.sign);
  json["distance"] = to_json(d);
  if (summary.of_points) json["distance"]["kind"] = "bounded", json["distance"]["weights"] = "points";
  json["extremes"] = extremes_json(summary);
  json[summary.of_points ? "points_with_value" : "texels_with_value"] = d.texels;
  json[summary.of_points ? "negative_points" : "negative_texels"] = d.negative_texels;
  json["beyond_max_distance"] = summary.beyond_max_distance;
  json[summary.of_points ? "beyond_max_distance_point_fraction" : "beyond_max_distance_area_fraction"] =
      summary.beyond_fraction;
  json["without_match"] = summary.without_match;
  json["accuracy"] = summary.evidence.accuracy;  // null: unknown
  json["accuracy_kind"] = std::isfinite(summary.evidence.accuracy) ? "bounded" : "unknown";
  if (!summary.of_points && !summary.of_thickness) add_surface(json, summary);
  json["evidence"] = fields_json(summary.evidence);
  if (summary.tolerance) json["tolerance"] = tolerance_json(summary);
  if (!summary.of_thickness)
    json["places"] = summary.places ? to_json(*summary.places, summary.of_points) : Json();
  json["doubts"] = to_json(summary.doubts);
  if (const auto& c = summary.coverage)
    json["coverage"] = {{"value", c->value},
                        {"kind", "estimate"},
                        {"lower", c->lower},
                        {"upper", c->upper},
                        {"reach", c->reach}};
  if (summary.distribution) add(json, *summary.distribution);
  if (summary.colors) json["notes"] = summary.notes;
  return json;
}

Json to_json(const MapReport& report, const Surface& surface, const Summary& summary) {
  Json json;
  json["version"] = kVersion;
  if (summary.of_itself) {
    json["mesh"] = to_json(report.on);
  } else {
    json["o1"] = to_json(report.on_o1 ? report.on : report.to);
    json["o2"] = to_json(report.on_o1 ? report.to : report.on);
    json[report.on_o1 ? "o2" : "o1"]["embedded"] = optional_json(report.embedded);
    json["measured_on"] = report.on_o1 ? "o1" : "o2";
  }
  json["units"] = summary.units;
  json["atlas"] = to_json(surface);
  if (!summary.of_itself) {
    json["atlas"]["udim"] = optional_json(report.udim);
    json["atlas"]["cut_faces"] = report.cut_faces;
    json["precision"] = optional_json(report.precision);
  }
  if (!report.engine.empty()) json["engine"] = report.engine;
  json.update(to_json(summary));
  json["time_ms"] = to_json(report.time_ms);
  return json;
}

Json to_json(std::span<const Doubt> doubts) {
  Json json = Json::array();
  for (const Doubt& doubt : doubts) json.push_back(fields_json(doubt));
  return json;
}

std::vector<Doubt> doubts_from(const Json& json) {
  std::vector<Doubt> doubts;
  for (const Json& doubt : json)
    doubts.push_back(
        {.reason =
             value_of<DoubtReason>(doubt.at("reason").get<std::string>()).value_or(DoubtReason::other_unit),
         .text = doubt.at("text"),
         .remedy = doubt.at("remedy")});
  return doubts;
}

Json to_json(const GroupVerdicts& verdicts, bool of_points) {
  Json groups = Json::array();
  for (const GroupVerdict& g : verdicts.groups) {
    const CertifiedVerdict& v = g.verdict;
    Json group{{"kind", g.kind}, {"group", g.group}, {"triangles", g.faces}};
    if (of_points) group["points"] = g.points;
    group.update(
        {{"lower", v.tolerance.lower},
         {"upper", v.tolerance.upper},
         {"verdict", name_of(v.verdict)},
         {"reason", name_of(v.reason)},
         {"certified", v.certified},
         {"lowest", optional_json(g.lowest)},
         {"highest", optional_json(g.highest)},
         {of_points ? "exceeded_point_fraction" : "exceeded_area_fraction", v.exceeded_area_fraction}});
    if (!of_points)
      group.update({{"undecided_by", v.proof ? optional_json(v.proof->undecided_by) : Json()},
                    {"witness", v.proof && v.proof->witness ? Json{{"distance", v.proof->witness->distance},
                                                                   {"point", v.proof->witness->point}}
                                                            : Json()}});
    groups.push_back(std::move(group));
  }
  Json all{{"verdict", name_of(verdicts.verdict)}};
  if (of_points)
    all.update({{"reason", reason_json(verdicts.without_group)},
                {"beyond_max_distance", verdicts.without_group.beyond_max_distance},
                {"without_match", verdicts.without_group.without_match}});
  all["groups"] = std::move(groups);
  return all;
}

Json to_json(const IslandReport& islands) {
  return fields_json(islands, {{"faces", "triangles"}});
}

Json to_json(const PointIslands& islands, std::uint64_t points) {
  return {{"islands", islands.islands},
          {"points", islands.points},
          {"point_fraction", static_cast<double>(islands.points) / static_cast<double>(points)},
          {"reach", islands.reach}};
}

Json to_json(const HausdorffDistance& distance, bool facing) {
  Json json = fields_json(distance.distance);
  json["faces"] = distance.faces;
  if (!facing) return json;
  json["faces_without_match"] = distance.faces_without_match;
  json["area_without_match"] = distance.area_without_match;
  return json;
}

Json to_json(const BoundedNumber& number, std::optional<double> confidence) {
  Json json = fields_json(number);
  if (number.certainty == Certainty::estimate && confidence) json["confidence"] = *confidence;
  return json;
}

Json to_json(const DirectedMetrics& metrics, const MetricsOptions& options, double confidence) {
  Json json{{"area", metrics.area},
            {"hausdorff", fields_json(metrics.hausdorff)},
            {"mean", to_json(metrics.mean, confidence)},
            {"rms", to_json(metrics.rms, confidence)}};
  if (options.estimate) json["points"] = metrics.points;
  json["percentiles"] = Json::array();
  json["within"] = Json::array();
  for (std::size_t i = 0; i < metrics.percentiles.size(); ++i) {
    json["percentiles"].push_back({{"percent", options.percentiles[i]}});
    json["percentiles"].back().update(to_json(metrics.percentiles[i], confidence));
  }
  for (std::size_t i = 0; i < metrics.within.size(); ++i) {
    json["within"].push_back({{"tolerance", options.tolerances[i]}});
    json["within"].back().update(to_json(metrics.within[i], confidence));
  }
  json["normal_consistency"] = metrics.normal_consistency;
  return json;
}

Json collision_json(bool colliding) {
  return {{"value", colliding}, {"kind", name_of(Certainty::exact)}};
}

Json to_json(const Contact& contact) {
  return {{"point1", contact.point1},
          {"point2", contact.point2},
          {"normal", contact.normal},
          {"depth", contact.depth},
          {"patch", contact.patch},
          {"faces", {contact.on[0].face, contact.on[1].face}},
          {"barycentric", {contact.on[0].barycentric, contact.on[1].barycentric}},
          {"id", contact.id}};
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

std::string tessellation_json(const Tessellation& tessellation) {
  return text_of(to_json(tessellation));
}

std::string mesh_json(const ReportedMesh& mesh) {
  return text_of(to_json(mesh));
}

std::string summary_json(const Summary& summary) {
  return text_of(to_json(summary));
}

std::string report_json(const MapReport& report, const Surface& surface, const Summary& summary) {
  return text_of(to_json(report, surface, summary));
}

}  // namespace sdm

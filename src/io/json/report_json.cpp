#include "io/json/report_json.h"

#include <sdm/version.h>

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
       {std::pair("min", summary.extreme_points[0]), std::pair("max", summary.extreme_points[1])}) {
    json[key]["at"] = "point";
    json[key]["index"] = index;
  }
  return json;
}

/// What is counted of a place: texels and their area or, of a cloud, points.
OtherKeys place_keys(bool of_points) {
  OtherKeys keys{{"face", "triangle"}, {"by_tolerance", ""}, {"largest", ""}};
  if (of_points)
    keys.insert(keys.end(), {{"sample", "index"},
                             {"samples", "points"},
                             {"area", ""},
                             {"fraction", "point_fraction"},
                             {"least_fraction", "least_point_fraction"}});
  else
    keys.insert(keys.end(), {{"sample", ""},
                             {"samples", "texels"},
                             {"fraction", "area_fraction"},
                             {"least_fraction", "least_area_fraction"}});
  return keys;
}

Json to_json(const Place& place, bool of_points) {
  Json json = fields_json(place, place_keys(of_points));
  insert_after(json, "point", "at", of_points ? "point" : place.sample == kNone ? "vertex" : "texel");
  for (const char* name : {"kind", "group"})
    if (json[name] == "") json[name] = nullptr;
  return json;
}

Json to_json(const Places& places, bool of_points) {
  Json json{{"kind", name_of(Certainty::estimate)}};
  json.update(fields_json(places, place_keys(of_points)));
  insert_after(json, "upper", "limits_from", places.by_tolerance ? "tolerance" : "p99_abs");
  json["largest"] = Json::array();
  for (const Place& place : places.largest) json["largest"].push_back(to_json(place, of_points));
  return json;
}

/// `exceeded`: the key of the fraction that is out of the tolerance.
Json to_json(const ToleranceVerdict& verdict, std::string_view exceeded) {
  return fields_json(verdict, {{"exceeded_area_fraction", exceeded}, {"largest", ""}});
}

/// What was proven where the samples did not decide.
Json to_json(const ToleranceProof& proof) {
  return fields_json(proof, {{"face", "triangle"}, {"closest_face", "closest_triangle"}});
}

Json tolerance_json(const Summary& summary) {
  const CertifiedVerdict& verdict = *summary.tolerance;
  const auto [lo, hi] = verdict.tolerance;
  Json json{{"value", lo == -hi ? Json(hi) : Json()}};
  json.update(to_json(verdict, summary.of_points ? "" : "exceeded_area_fraction"));
  insert_after(json, "reason", "text", verdict_text(summary));
  insert_after(json, "text", "next", fields_json(next_steps(summary)));
  if (summary.of_points) {
    insert_after(json, "text", "exceeded_points", summary.exceeding_points);
    insert_after(json, "exceeded_points", "exceeded_point_fraction", summary.exceeding_point_fraction);
  } else {
    insert_after(json, "exceeded_area_fraction", "area_fractions", fields_json(verdict.shares));
  }
  json["nearest_limit"] = verdict.nearest_is_lower ? "lower" : "upper";
  json["proof"] = verdict.proof ? to_json(*verdict.proof) : Json();
  json["by_facing"] = value_json(verdict.by_facing);
  json["by_places"] = verdict.by_places ? fields_json(*verdict.by_places) : Json();
  return json;
}

Json to_json(const PartTable& table) {
  Json rows = Json::array();
  for (const auto& [name, part, first_face] : table.rows) {
    Json row;
    if (table.kind != "component") row["name"] = name.empty() ? Json() : Json(name);
    row["triangles"] = part.faces;
    row["first_triangle"] = first_face;
    row["bounds"] = fields_json(part.box);
    row["area_fraction"] = part.area_fraction;
    row["distance"] = to_json(part.distance);
    row["texels_with_value"] = part.distance.texels;
    if (part.tolerance) row["tolerance"] = fields_json(*part.tolerance);
    rows.push_back(std::move(row));
  }
  return {{"kind", table.kind}, {"count", table.count}, {"largest", std::move(rows)}};
}

void add(Json& json, const Distribution& distribution) {
  json["histogram"] = value_json(distribution.histogram);
  json["bands"] = value_json(distribution.bands);  // null: no limit
  json["components"] = to_json(distribution.parts.front());
  json["groups"] = Json::array();
  for (std::size_t i = 1; i < distribution.parts.size(); ++i)
    json["groups"].push_back(to_json(distribution.parts[i]));
}

Json largest_json(const Summary& summary) {
  const LargestDistance& d = summary.hausdorff;
  return {{"lower", value_json(d.lower)},
          {"upper", value_json(d.upper)},
          {"kind", d.lower ? "bounded" : "unknown"},
          {"point", value_json(d.point)}};
}

/// The value of an option in the type that it is declared with; null: absent, or no limit.
Json setting_json(const GivenOption& option) {
  const auto& [name, value, type] = option;
  if (value.empty()) return {};
  if (type == "flag") return value == "true";
  if (type == "integer") return *core::parse_number<std::uint64_t>(value);
  if (type == "number") return *core::parse_number(value);  // dump() writes null for infinity
  if (type == "texts") {
    std::vector<std::string> texts;
    OptionForm<std::vector<std::string>>::read(value, {}, texts);
    return texts;
  }
  std::vector<double> numbers;
  const bool several = type == "numbers" || type == "interval" || type == "point" || type == "direction";
  return several && read_numbers(value, {}, 0, numbers) ? Json(numbers) : Json(value);
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

/// Null unless points are without a group.
Json reason_json(const PointsWithoutGroup& points) {
  if (!points.any()) return nullptr;
  return name_of(points.without_match > 0 ? VerdictReason::without_match
                                          : VerdictReason::beyond_max_distance);
}

}  // namespace

Json settings_json(const std::vector<GivenOption>& settings) {
  Json json = Json::object();
  for (const GivenOption& option : settings) json[option.name] = setting_json(option);
  return json;
}

Json to_json(const Tessellation& t) {
  Json json = fields_json(t, {{"measured_points", ""}});
  if (t.file_unit.empty()) json["file_unit"] = nullptr;
  insert_after(json, "file_unit", "unit", "mm");
  json["largest_deviation"] = {
      {"value", t.largest_deviation}, {"kind", name_of(Certainty::estimate)}, {"points", t.measured_points}};
  return json;
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
  if (summary.of_points) {
    json["distance"]["kind"] = "bounded";
    json["distance"]["weights"] = "points";
  }
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
  if (summary.coverage) {
    json["coverage"] = fields_json(*summary.coverage);
    insert_after(json["coverage"], "value", "kind", name_of(Certainty::estimate));
  }
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
    json[report.on_o1 ? "o2" : "o1"]["embedded"] = value_json(report.embedded);
    json["measured_on"] = report.on_o1 ? "o1" : "o2";
  }
  json["units"] = summary.units;
  json["atlas"] = to_json(surface);
  if (!summary.of_itself) {
    json["atlas"]["udim"] = value_json(report.udim);
    json["atlas"]["cut_faces"] = report.cut_faces;
    json["precision"] = value_json(report.precision);
  }
  if (!report.engine.empty()) json["engine"] = report.engine;
  json.update(to_json(summary));
  json["time_ms"] = fields_json(report.time_ms);
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
    Json group = fields_json(
        g, {{"faces", "triangles"}, {"points", of_points ? "points" : ""}, {"area", ""}, {"verdict", ""}});
    group.update(to_json(g.verdict, of_points ? "exceeded_point_fraction" : "exceeded_area_fraction"));
    if (!of_points) {
      const std::optional<ToleranceProof>& proof = g.verdict.proof;
      group["undecided_by"] = proof ? value_json(proof->undecided_by) : Json();
      group["witness"] = nullptr;
      if (proof && proof->witness)
        group["witness"] = {{"distance", proof->witness->distance}, {"point", proof->witness->point}};
    }
    groups.push_back(std::move(group));
  }
  Json all = fields_json(verdicts, {{"groups", ""}});
  if (of_points) {
    all["reason"] = reason_json(verdicts.without_group);
    all.update(fields_json(verdicts.without_group));
  }
  all["groups"] = std::move(groups);
  return all;
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

#include "report.h"

#include <cmath>
#include <cstdio>

using Json = nlohmann::ordered_json;

namespace {

const char* name(sdm::AtlasKind kind) {
  return kind == sdm::AtlasKind::charts ? "charts" : kind == sdm::AtlasKind::triangles ? "triangles" : "uv";
}

const char* name(sdm::SignMethod method) {
  switch (method) {
    case sdm::SignMethod::pseudonormal:
      return "pseudonormal";
    case sdm::SignMethod::winding:
      return "winding";
    default:
      return "none";
  }
}

const char* name(sdm::GlClip clip) {
  return clip == sdm::GlClip::planes ? "planes" : "stencil";
}

double overdraw(const sdm::GlReport& r) {
  return r.texels == 0 ? 0 : static_cast<double>(r.fragments) / static_cast<double>(r.texels);
}

// Milliseconds, to the microsecond.
double rounded(double ms) {
  return std::round(1000 * ms) / 1000;
}

Json to_json(const sdm::GlReport& r) {
  const sdm::GlReport::Times& t = r.time_ms;
  return {{"device", {{"name", r.device.name}, {"driver", r.device.driver}, {"software", r.device.software}}},
          {"clip", name(r.clip)},
          {"sites", r.sites},
          {"sites_dropped", r.sites_dropped},
          {"faces", r.faces},
          {"tiles", r.tiles},
          {"pairs", r.pairs},
          {"bound_tests", r.bound_tests},
          {"obb_tests", r.obb_tests},
          {"culled_by_bound", r.culled_by_bound},
          {"culled_by_obb", r.culled_by_obb},
          {"clipped_away", r.clipped_away},
          {"polygons", r.polygons},
          {"fragments", r.fragments},
          {"texels", r.texels},
          {"overdraw", overdraw(r)},
          {"batches", r.batches},
          {"unconfirmed", r.unconfirmed},
          {"stencil_lookups", r.stencil_lookups},
          {"stencil_hits", r.stencil_hits},
          {"stencil_misses", r.stencil_misses},
          {"stencil_evictions", r.stencil_evictions},
          {"stencil_clears", r.stencil_clears},
          {"time_ms",
           {{"context", rounded(t.context)},
            {"refit", rounded(t.refit)},
            {"bounds", rounded(t.bounds)},
            {"cull", rounded(t.cull)},
            {"draw", rounded(t.draw)},
            {"read_back", rounded(t.read_back)},
            {"finish", rounded(t.finish)}}}};
}

}  // namespace

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

Input load_input(const std::string& role, const std::string& file, const std::string& transform) {
  Input input{role, file, transform, sdm::read_mesh(file), {}};
  sdm::transform(input.mesh, sdm::parse_transform(transform));
  input.info = sdm::inspect(input.mesh);
  return input;
}

Json to_json(const Input& input) {
  return {{"file", input.file},
          {"transform", input.transform},
          {"vertices", input.info.vertices},
          {"triangles", input.info.triangles},
          {"closed", input.info.closed},
          {"degenerate_faces", input.info.degenerate_faces},
          {"duplicate_faces", input.info.duplicate_faces}};
}

Json to_json(const sdm::Surface& surface) {
  return {{"kind", name(surface.atlas_kind())},   {"resolution", surface.resolution()},
          {"charts", surface.chart_count()},      {"texels", surface.sample_texels().size()},
          {"utilisation", surface.utilisation()}, {"max_stretch", surface.max_stretch()}};
}

Json to_json(const sdm::DistanceStatistics& d) {
  // NaN, where no texel has a value, becomes null.
  return {{"kind", "estimate"}, {"min", d.min}, {"max", d.max}, {"mean", d.mean},
          {"rms", d.rms},       {"p50", d.p50}, {"p95", d.p95}, {"p99", d.p99}};
}

Json to_json(const Outcome& outcome) {
  const sdm::DistanceStatistics& d = outcome.distance;
  Json json;
  json["sign"] = {{"method", name(outcome.sign.method)}, {"reason", outcome.sign.reason}};
  json["distance"] = to_json(d);
  json["texels_with_value"] = d.texels;
  json["negative_texels"] = d.negative_texels;
  json["beyond_max_distance"] = outcome.beyond_max_distance;
  json["error_bound"] = outcome.error_bound;
  json["error_bound_kind"] = "bounded";
  if (outcome.tolerance)
    json["tolerance"] = {{"value", outcome.tolerance->value},
                         {"exceeded_area_fraction", outcome.tolerance->exceeded_area_fraction},
                         {"within", outcome.tolerance->within},
                         {"certified", outcome.tolerance->certified}};
  if (outcome.raster) json["raster"] = to_json(*outcome.raster);
  const Times& t = outcome.time;
  json["time_ms"] = {{"import", t.import}, {"atlas", t.atlas},   {"sites", t.sites},
                     {"map", t.map},       {"export", t.output}, {"total", t.total}};
  return json;
}

std::string to_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::ignore) + "\n";
}

std::string summary(const Input& on, const Input& to, const Outcome& outcome, const std::string& units) {
  const sdm::DistanceStatistics& d = outcome.distance;
  const std::string unit = units.empty() ? "" : " " + units;
  std::string text = on.file + " -> " + to.file + "\n";
  if (d.texels == 0) {
    text += "  distance  no texel is within the maximum distance\n";
  } else {
    text += "  distance  min " + number(d.min) + "   mean " + number(d.mean) + "   max " + number(d.max) +
            unit + "\n";
    if (outcome.sign.method != sdm::SignMethod::none)
      text += "            " +
              number(100.0 * static_cast<double>(d.negative_texels) / static_cast<double>(d.texels)) +
              " % of the texels are inside (negative)\n";
  }
  if (outcome.sign.method == sdm::SignMethod::none)
    text += "            unsigned: " + outcome.sign.reason + "\n";
  if (outcome.beyond_max_distance > 0)
    text += "            " + std::to_string(outcome.beyond_max_distance) +
            " texels are farther than --max-distance\n";
  text += "  error     at most " + number(outcome.error_bound) + unit +
          ", everywhere between the texels (whose values are exact)\n";
  if (outcome.tolerance)
    text += std::string("  tolerance ") + (outcome.tolerance->within ? "kept" : "exceeded on ") +
            (outcome.tolerance->within
                 ? ""
                 : number(100 * outcome.tolerance->exceeded_area_fraction) + " % of the area") +
            (outcome.tolerance->certified ? "\n" : " at the samples, not certified between them\n");
  if (outcome.raster)
    text += "  raster    " + outcome.raster->device.name + ", " + std::to_string(outcome.raster->polygons) +
            " polygons, overdraw " + number(overdraw(*outcome.raster)) + "\n";
  return text;
}

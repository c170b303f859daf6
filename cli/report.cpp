#include "report.h"

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

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

}  // namespace

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
          {"charts", surface.chart_count()},      {"texels", surface.samples().size()},
          {"utilisation", surface.utilisation()}, {"max_stretch", surface.max_stretch()}};
}

Json to_json(const Outcome& outcome) {
  const sdm::DistanceStatistics& d = outcome.distance;
  Json json;
  json["sign"] = {{"method", name(outcome.sign.method)}, {"reason", outcome.sign.reason}};
  // NaN, where no texel has a value, becomes null.
  json["distance"] = {{"kind", "estimate"}, {"min", d.min}, {"max", d.max}, {"mean", d.mean},
                      {"rms", d.rms},       {"p50", d.p50}, {"p95", d.p95}, {"p99", d.p99}};
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
          ", anywhere between the texels (where the values are exact)\n";
  if (outcome.tolerance)
    text += std::string("  tolerance ") + (outcome.tolerance->within ? "kept" : "exceeded on ") +
            (outcome.tolerance->within
                 ? ""
                 : number(100 * outcome.tolerance->exceeded_area_fraction) + " % of the area") +
            (outcome.tolerance->certified ? "\n" : " at the samples, not certified between them\n");
  return text;
}

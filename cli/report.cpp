#include "report.h"

#include <cmath>

#include "format.h"
#include "notes.h"
#include "scenes/placement.h"

using Json = nlohmann::ordered_json;

namespace {

const char* atlas_name(sdm::AtlasKind kind) {
  return kind == sdm::AtlasKind::charts ? "charts" : kind == sdm::AtlasKind::triangles ? "triangles" : "uv";
}

const char* colormap_name(sdm::Colormap colormap) {
  switch (colormap) {
    case sdm::Colormap::diverging:
      return "diverging";
    case sdm::Colormap::paper2006:
      return "paper2006";
    default:
      return "viridis";
  }
}

const char* clip_name(sdm::GlClip clip) {
  return clip == sdm::GlClip::planes ? "planes" : "stencil";
}

double overdraw(const sdm::GlReport& r) {
  return r.texels == 0 ? 0 : static_cast<double>(r.fragments) / static_cast<double>(r.texels);
}

// Milliseconds, rounded to microseconds.
double rounded(double ms) {
  return std::round(1000 * ms) / 1000;
}

Json gl_json(const sdm::GlReport& r) {
  const sdm::GlReport::Times& t = r.time_ms;
  return {{"device", {{"name", r.device.name}, {"driver", r.device.driver}, {"software", r.device.software}}},
          {"clip", clip_name(r.clip)},
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

const char* sign_name(sdm::SignMethod method) {
  switch (method) {
    case sdm::SignMethod::exact:
      return "exact";
    case sdm::SignMethod::winding:
      return "winding";
    default:
      return "none";
  }
}

Input load_input(const std::string& role, const std::string& file, const std::string& transform,
                 const sdm::MeshFileOptions& options) {
  sdm::MeshFile read = sdm::read_mesh_file(file, options);
  Input input{.role = role, .file = file, .transform = transform, .mesh = std::move(read.mesh)};
  input.names = std::move(read.names);
  input.vertices = std::move(read.vertices);
  for (const std::string& note : read.notes) input.notes.push_back(fmt::format("{}: {}", file, note));
  if (const auto note = note_on_precision(file, input.mesh.positions, size_of(sdm::bounds(input.mesh))))
    input.notes.push_back(*note);
  sdm::scenes::place(input.mesh, sdm::scenes::parse_placement(transform));
  return input;
}

void inspect(Input& input) {
  if (!input.info) input.info = sdm::inspect(input.mesh);
}

Json to_json(const Input& input) {
  return {{"file", input.file},
          {"transform", input.transform},
          {"vertices", input.info->vertices},
          {"triangles", input.info->triangles},
          {"closed", input.info->closed},
          {"degenerate_faces", input.info->degenerate_faces},
          {"duplicate_faces", input.info->duplicate_faces}};
}

Json to_json(const sdm::Surface& surface) {
  return {{"kind", atlas_name(surface.atlas_kind())},
          {"resolution", surface.resolution()},
          {"rows", surface.rows()},
          {"charts", surface.chart_count()},
          {"texels", surface.sample_texels().size()},
          {"utilisation", surface.utilisation()},
          {"max_stretch", surface.max_stretch()},
          {"gutter", surface.gutter()},
          {"overlapping_texels", surface.overlapping_texels()}};
}

Json colors_json(const sdm::PictureOptions& fixed, const sdm::PictureOptions& given) {
  const bool bands = fixed.colormap == sdm::Colormap::automatic;
  return {{"map", bands ? "tolerance" : colormap_name(fixed.colormap)},
          {"range", *fixed.range},
          {"range_from", given.range ? "option" : "p99_abs"}};
}

namespace {

Json extreme_json(const sdm::Extreme& extreme) {
  if (std::isnan(extreme.distance)) return nullptr;
  return {{"distance", extreme.distance},
          {"point", extreme.point},
          {"at", extreme.at_vertex ? "vertex" : "texel"}};
}

}  // namespace

Json one_sided_hausdorff(const Outcome& outcome) {
  const sdm::Extremes& extremes = outcome.extremes;
  const sdm::Extreme& most = -extremes.min.distance > extremes.max.distance ? extremes.min : extremes.max;
  Json json{{"lower", nullptr}, {"upper", nullptr}, {"kind", "unknown"}, {"point", nullptr}};
  if (!std::isfinite(outcome.accuracy)) return json;
  const double largest = std::isnan(most.distance) ? 0 : std::abs(most.distance);
  json["kind"] = "bounded";
  if (outcome.beyond_max_distance > 0) {  // somewhere, and not known by how much
    json["lower"] = std::max(0.0, outcome.max_distance - outcome.accuracy);
    return json;
  }
  json["lower"] = std::max(0.0, largest - outcome.accuracy);
  json["upper"] = largest + outcome.error_bound + outcome.accuracy;
  json["point"] = most.point;
  return json;
}

Json measures_json(const Outcome& outcome) {
  const sdm::DistanceStatistics& d = outcome.distance;
  Json json;
  json["sign"] = {{"method", sign_name(outcome.sign.method)}, {"reason", outcome.sign.reason}};
  json["distance"] = to_json(d);
  json["extremes"] = {{"min", extreme_json(outcome.extremes.min)},
                      {"max", extreme_json(outcome.extremes.max)}};
  json["texels_with_value"] = d.texels;
  json["negative_texels"] = d.negative_texels;
  json["beyond_max_distance"] = outcome.beyond_max_distance;
  json["boundary_texels"] = outcome.boundary_texels;
  const bool known = std::isfinite(outcome.accuracy);
  json["accuracy"] = outcome.accuracy;  // null: unknown
  json["accuracy_kind"] = known ? "bounded" : "unknown";
  json["error_bound"] = known ? Json(outcome.error_bound) : Json();
  json["error_bound_kind"] = known ? "bounded" : "unknown";
  json["hausdorff"] = {{"one_sided", one_sided_hausdorff(outcome)}};
  if (outcome.tolerance) json["tolerance"] = to_json(*outcome.tolerance);
  return json;
}

Json to_json(const Outcome& outcome) {
  Json json = measures_json(outcome);
  json.update(to_json(outcome.numbers));
  json["notes"] = outcome.notes;
  if (outcome.raster) json["raster"] = gl_json(*outcome.raster);
  const Times& t = outcome.time;
  json["time_ms"] = {{"import", t.import}, {"atlas", t.atlas},   {"sites", t.sites},
                     {"map", t.map},       {"export", t.output}, {"total", t.total}};
  return json;
}

void add_symmetric_hausdorff(Json& o1, Json& o2) {
  const Json &a = o1["hausdorff"]["one_sided"], &b = o2["hausdorff"]["one_sided"];
  const auto larger = [&](const char* key) {
    return a[key].is_null() || b[key].is_null() ? Json()
                                                : Json(std::max(a[key].get<double>(), b[key].get<double>()));
  };
  const Json both{{"lower", larger("lower")}, {"upper", larger("upper")}, {"kind", a["kind"]}};
  o1["hausdorff"]["symmetric"] = o2["hausdorff"]["symmetric"] = both;
}

std::string to_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::ignore) + "\n";
}

namespace {

// The texel or vertex that exceeds a tolerance most.
std::string farthest(const Outcome& outcome, const std::string& unit) {
  const auto& [min, max] = outcome.extremes;
  const sdm::Tolerance& tolerance = outcome.tolerance->tolerance;
  const sdm::Extreme& most = tolerance.lo - min.distance > max.distance - tolerance.hi ? min : max;
  if (std::isnan(most.distance)) return "no texel has a value";
  return fmt::format("{}{} at {} {}", number(most.distance), unit, most.at_vertex ? "vertex" : "texel",
                     place(most.point, outcome.size));
}

// The --precision that would decide, and the resolution that it needs: texels are about as far apart as the
// error bound is long.
std::string deciding_precision(const Outcome& outcome, const std::string& unit) {
  const double bound = outcome.tolerance->deciding_bound;
  if (!(bound > 0)) return "no --precision decides, as a distance is within rounding of a limit";
  const double finer = outcome.error_bound / bound;
  if (std::max(outcome.resolution, outcome.rows) * finer > 32768)
    return fmt::format("an error of {}{} would decide, but needs more than 32768² texels", number(bound, 2),
                       unit);
  const double columns = outcome.resolution * finer, rows = outcome.rows * finer;
  if (columns != rows)
    return fmt::format("an error of {}{} would decide (about --resolution {:.0f}x{:.0f})", number(bound, 2),
                       unit, columns, rows);
  return fmt::format("--precision {} would decide (about {:.0f}² texels)", number(bound, 2), columns);
}

std::string tolerance_line(const Outcome& outcome, const std::string& unit) {
  const sdm::ToleranceVerdict& verdict = *outcome.tolerance;
  const sdm::ToleranceShares& shares = verdict.shares;
  const auto [lo, hi] = verdict.tolerance;
  const std::string limits = lo == -hi ? fmt::format("±{}{}", number(hi), unit)
                                       : fmt::format("{} to {}{}", number(lo), number(hi), unit);
  const std::string word = verdict_name(verdict.verdict);
  switch (verdict.verdict) {
    case sdm::Verdict::pass:
      return fmt::format("{}: every point of the surface is within {}", word, limits);
    case sdm::Verdict::not_decided:
      return fmt::format("{}: all samples are within {}, but points between them may not be; {}", word,
                         limits, deciding_precision(outcome, unit));
    case sdm::Verdict::fail:
      break;
  }
  std::string text = fmt::format("{}: {} % of the area is out of {}", word,
                                 number(100 * verdict.exceeded_area_fraction), limits);
  if (outcome.sign.method != sdm::SignMethod::none)
    text += fmt::format(" ({} % above, {} % below)", number(100 * shares.above), number(100 * shares.below));
  return text + "; " + farthest(outcome, unit);
}

}  // namespace

std::string summary(const Input& on, const Input& to, const Outcome& outcome, const std::string& units) {
  const sdm::DistanceStatistics& d = outcome.distance;
  const std::string unit = unit_suffix(units);
  std::string text = fmt::format("{} -> {}\n", on.file, to.file);
  const auto add = [&]<class... Values>(fmt::format_string<Values...> line, Values&&... values) {
    fmt::format_to(std::back_inserter(text), line, std::forward<Values>(values)...);
  };
  if (d.texels == 0) {
    add("  distance  no texel is within the maximum distance\n");
  } else {
    const auto& [min, max] = outcome.extremes;
    add("  distance  min {}   mean {}   max {}{}\n", number(min.distance), number(d.mean),
        number(max.distance), unit);
    add("            mean |d| {}   rms {}   σ {}{}\n", number(d.mean_abs), number(d.rms), number(d.stddev),
        unit);
    add("            95 % of the area has |d| up to {}, 99 % up to {}{}\n", number(d.p95_abs),
        number(d.p99_abs), unit);
    if (outcome.sign.method != sdm::SignMethod::none)
      add("            {} % of the area is inside (negative)\n", number(100 * d.negative_area_fraction));
  }
  if (outcome.sign.method == sdm::SignMethod::none) add("            unsigned: {}\n", outcome.sign.reason);
  if (outcome.beyond_max_distance > 0)
    add("            {} texels are farther than --max-distance\n", outcome.beyond_max_distance);
  if (std::isfinite(outcome.accuracy))
    add("  error     at most {}{} between the texels, whose values are exact\n", number(outcome.error_bound),
        unit);
  else
    add("  error     unknown: the paper's algorithm as printed gives an estimate\n");
  if (outcome.tolerance) add("  tolerance {}\n", tolerance_line(outcome, unit));
  text += note_lines(outcome.notes, 12);
  if (outcome.raster)
    add("  raster    {}, {} polygons, overdraw {}\n", outcome.raster->device.name, outcome.raster->polygons,
        number(overdraw(*outcome.raster)));
  return text;
}

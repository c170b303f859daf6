#include "report.h"

#include "bounds_text.h"
#include "cad_options.h"
#include "exit_codes.h"
#include "format.h"
#include "group_tolerances.h"
#include "notes.h"
#include "places.h"
#include "src/io/json/report_json.h"
#include "src/io/mesh/placement.h"

using Json = nlohmann::ordered_json;

Input load_input(const std::string& role, const std::string& file, const std::string& transform,
                 const sdm::MeshFileOptions& options) {
  const std::vector<sdm::io::PlacementStep> steps = sdm::io::parse_placement(transform);
  sdm::MeshFileOptions reading = options;
  reading.tessellation = before_placement(options.tessellation, steps);
  sdm::MeshFile read = sdm::read_mesh_file(file, reading);
  Input input{.role = role, .file = file, .transform = transform, .mesh = std::move(read.mesh)};
  input.xxh3 = std::move(read.xxh3);
  input.names = std::move(read.names);
  input.vertices = std::move(read.vertices);
  input.tessellation = std::move(read.tessellation);
  input.look = {std::move(read.materials), std::move(read.textures), std::move(read.face_materials),
                std::move(read.attributes)};
  if (input.tessellation) input.notes.push_back(sdm::note_on(*input.tessellation, file));
  for (const std::string& note : read.notes) input.notes.push_back(fmt::format("{}: {}", file, note));
  if (const auto note = note_on_precision(file, input.mesh.positions, size_of(sdm::bounds(input.mesh))))
    input.notes.push_back(*note);
  if (input.tessellation)
    input.deviation = placed_deviation(input.tessellation, sdm::io::without_fit(input.mesh, steps));
  sdm::io::place(input.mesh, steps);
  return input;
}

void inspect(Input& input) {
  if (input.info) return;
  input.info = sdm::inspect(input.mesh);
  const auto of_islands = static_cast<std::size_t>(std::ranges::count(input.island_vertices, 1));
  input.info->vertices -= of_islands;
  input.info->unused_vertices -= of_islands;
}

sdm::ReportedMesh reported(const Input& input) {
  return {.file = input.file,
          .transform = input.transform,
          .info = *input.info,
          .weld = input.weld,
          .tessellation = input.tessellation,
          .xxh3 = input.xxh3};
}

Json to_json(const Input& input) {
  return sdm::to_json(reported(input));
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

std::string farthest(const Outcome& outcome, const std::string& unit) {
  const std::optional<sdm::Extreme> most = decisive_extreme(outcome.summary);
  if (!most) return "no texel has a value";
  return fmt::format("{}{} at {} {}", number(most->distance), unit, most->at_vertex ? "vertex" : "texel",
                     place(most->point, outcome.size));
}

bool is_along(const sdm::Summary& summary) {
  return summary.measured.kind == sdm::DistanceKind::along;
}

std::string tolerance_line(const Outcome& outcome, const std::string& unit) {
  const sdm::CertifiedVerdict& verdict = *outcome.summary.tolerance;
  const std::string word = sdm::name_of(verdict.verdict);
  if (verdict.verdict != sdm::Verdict::fail)
    return fmt::format("{}: {}", word, sdm::verdict_text(outcome.summary));
  const sdm::ToleranceShares& shares = verdict.shares;
  const std::string limits =
      sdm::limits_text(verdict.tolerance, outcome.summary.units, outcome.summary.evidence.is_signed) +
      sdm::uncertainty_text(outcome.summary.evidence.uncertainty, outcome.summary.units);
  if (verdict.proof && verdict.proof->witness)
    return fmt::format("{}: {}: {}{} at {}", word,
                       verdict.by_facing.value_or(false) ? sdm::verdict_text(outcome.summary)
                                                         : "a point between the texels is out of " + limits,
                       number(verdict.proof->witness->distance), unit,
                       place(verdict.proof->witness->point, outcome.size));
  if (verdict.proof && verdict.reason == sdm::VerdictReason::without_match)
    return fmt::format("{}: {} no texel and no value, as {}", word,
                       verdict.proof->faces_without_match == 1
                           ? "1 face has"
                           : fmt::format("{} faces have", verdict.proof->faces_without_match),
                       sdm::verdict_text(outcome.summary));
  if (verdict.reason == sdm::VerdictReason::without_match ||
      verdict.reason == sdm::VerdictReason::beyond_max_distance) {
    const std::string what =
        shares.without_value > 0 ? number(100 * shares.without_value) + " % of the area has" : "a vertex has";
    return fmt::format("{}: {} no value, as {}", word, what, sdm::verdict_text(outcome.summary));
  }
  std::string text = fmt::format("{}: {} % of the area is out of {}", word,
                                 number(100 * verdict.exceeded_area_fraction), limits);
  if (outcome.summary.sign.method != sdm::SignMethod::none)
    text += fmt::format(" ({} % above, {} % below)", number(100 * shares.above), number(100 * shares.below));
  return text + "; " + farthest(outcome, unit);
}

}  // namespace

std::optional<sdm::Verdict> judged(const sdm::Summary& summary,
                                   const std::optional<sdm::GroupVerdicts>& groups) {
  std::optional<sdm::Verdict> verdict;
  if (summary.tolerance) verdict = summary.tolerance->verdict;
  if (groups) verdict = verdict ? worse(*verdict, groups->verdict) : groups->verdict;
  return verdict;
}

std::string heading(const std::string& title, std::optional<sdm::Verdict> verdict) {
  return verdict ? fmt::format("{}: {}\n", sdm::name_of(*verdict), title) : title + "\n";
}

std::string measured_line(const sdm::Summary& summary) {
  if (summary.measured.kind == sdm::DistanceKind::closest) return {};
  return fmt::format("  measured  {}\n", summary.measured.text);
}

const char* side_word(const sdm::SignUsed& sign) {
  return sign.method == sdm::SignMethod::side ? "behind" : "inside";
}

std::string coverage_line(const sdm::Summary& summary) {
  if (!summary.coverage) return {};
  const sdm::Coverage& c = *summary.coverage;
  return fmt::format("  coverage  {} % of O2 has a measured point within {}{} ({} %)\n",
                     number(100 * c.value, 4), number(c.reach), unit_suffix(summary.units),
                     bounds_text(100 * c.lower, 100 * c.upper, 4));
}

std::string doubt_lines(std::span<const sdm::Doubt> doubts, std::size_t column) {
  std::string text;
  for (const sdm::Doubt& doubt : doubts)
    text += fmt::format("  {:<{}}{}; {}\n", "doubt", column - 2, doubt.text, doubt.remedy);
  return text;
}

std::optional<sdm::Extreme> decisive_extreme(const sdm::Summary& summary) {
  if (!summary.extremes) return std::nullopt;
  return summary.tolerance->nearest_is_lower ? summary.extremes->min : summary.extremes->max;
}

std::string summary(const Input& on, const Input& to, const Outcome& outcome) {
  const sdm::Summary& s = outcome.summary;
  const sdm::DistanceStatistics& d = s.distance;
  const std::string unit = unit_suffix(s.units);
  std::string text = heading(fmt::format("{} -> {}", on.file, to.file), judged(s, outcome.groups));
  const auto add = [&]<class... Values>(fmt::format_string<Values...> line, Values&&... values) {
    text += fmt::format(line, std::forward<Values>(values)...);
  };
  text += measured_line(s);
  if (d.texels == 0 || !s.extremes) {
    add("  distance  no texel {}\n", s.without_match == 0 ? "is within the maximum distance"
                                     : is_along(s)        ? "has such a face on its line"
                                                          : "has a face that faces it");
  } else {
    const auto& [min, max] = *s.extremes;
    add("  distance  min {}   mean {}   max {}{}\n", number(min.distance), number(d.mean),
        number(max.distance), unit);
    add("            mean |d| {}   rms {}   σ {}{}\n", number(d.mean_abs), number(d.rms), number(d.stddev),
        unit);
    add("            95 % of the area has |d| up to {}, 99 % up to {}{}\n", number(d.p95_abs),
        number(d.p99_abs), unit);
    if (s.sign.method != sdm::SignMethod::none)
      add("            {} % of the area is {} (negative)\n", number(100 * d.negative_area_fraction),
          side_word(s.sign));
  }
  if (s.sign.method == sdm::SignMethod::none) add("            unsigned: {}\n", s.sign.reason);
  if (s.beyond_max_distance > 0)
    add("            {} texels, {} % of the area, are farther than --max-distance\n", s.beyond_max_distance,
        number(100 * s.beyond_fraction));
  if (s.without_match > 0)
    add("            {} texels have no {}\n", s.without_match,
        is_along(s) ? "such face on their line" : "face that faces them");
  if (sdm::lacks_boundary_signs(s.measured.kind, s.sign.method))
    add("            signs are estimates ({} texels and {} vertices at the boundary of O2 have none: |d|)\n",
        s.boundary_texels, outcome.boundary_vertices);
  if (s.evidence.samples_only)
    add("  error     unknown between the texels, whose values are exact: there, all {} an estimate\n",
        s.tolerance && s.tolerance->proof && s.tolerance->certified ? "but the verdict is" : "is");
  else
    add("  error     at most {}{} between the texels, whose values are exact\n",
        number(s.evidence.error_bound), unit);
  if (s.tolerance) add("  tolerance {}\n", tolerance_line(outcome, unit));
  text += place_lines(s, outcome.size);
  if (outcome.groups) text += group_lines(*outcome.groups, s);
  text += coverage_line(s) + doubt_lines(s.doubts, 12) + note_lines(s.notes, 12);
  if (outcome.raster)
    add("  raster    {}, {} polygons, overdraw {}\n", outcome.raster->device.name, outcome.raster->polygons,
        number(outcome.raster->overdraw()));
  if (outcome.gpu) add("  gpu       {}\n", outcome.gpu->device);
  return text;
}

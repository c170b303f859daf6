#include "bake_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sdm/version.h>

#include <cmath>

#include "format.h"
#include "src/io/json/report_json.h"

namespace {

using Json = nlohmann::ordered_json;

Json atlas_json(const BakeCommand& command, const sdm::Surface& surface) {
  return {{"kind", sdm::name_of(surface.atlas_kind())},
          {"resolution", surface.resolution() / command.request.side()},
          {"rows", surface.rows() / command.request.side()},
          {"samples", command.request.samples},
          {"charts", surface.chart_count()},
          {"texels", surface.owned_texels()},
          {"utilisation", surface.utilisation()},
          {"overlapping_texels", surface.overlapping_texels()}};
}

}  // namespace

Json report_of(const BakeCommand& command, const Input& high, const Input& low, const BakeResult& result) {
  Json report{{"version", sdm::kVersion},
              {"high", to_json(high)},
              {"low", to_json(low)},
              {"units", command.units},
              {"atlas", atlas_json(command, *result.low.surface)}};
  const bool limited = std::isfinite(command.request.max_distance);
  report["max_distance"] = limited ? Json(command.request.max_distance) : Json();
  const sdm::MatchOptions matching = match_options(command.request);
  const bool facing = matching.method != sdm::MatchMethod::closest;
  report["match"] = name_of(matching.method);
  report["facing"] = facing ? Json(matching.facing) : Json();
  report["cage"] = command.request.cage ? Json(*command.request.cage) : Json();
  report["texels"] = sdm::fields_json(result.matches);
  report["textures"] = result.channels.report;
  report["settings"] = sdm::settings_json(command.request);
  report["notes"] = result.notes;
  report["time_ms"] = {{"import", result.time.import},
                       {"match", result.time.match},
                       {"bake", result.time.bake},
                       {"export", result.time.output},
                       {"total", result.time.total}};
  return report;
}

std::string text_of(const BakeCommand& command, const BakeResult& result) {
  const sdm::Surface& surface = *result.low.surface;
  const sdm::MatchCounts& counts = result.matches;
  const std::uint32_t side = command.request.side();
  std::string text = fmt::format("{} -> {}\n", command.high, command.low);
  text += fmt::format("  baked     {}, {} x {} texels{}\n", fmt::join(result.channels.names, ", "),
                      surface.resolution() / side, surface.rows() / side,
                      side == 1 ? "" : fmt::format(" of {} samples", side * side));
  text += fmt::format("  {}   {} have a point of HIGH{}\n", side == 1 ? "texels " : "samples",
                      counts.matched(), counts.facing + counts.ray > 0 ? " on a face that faces them" : "");
  if (counts.ray > 0)
    text += fmt::format("            {} of them by a ray along the normal of LOW\n", counts.ray);
  if (counts.too_far > 0)
    text += fmt::format("            {} are farther than --max-distance, and filled\n", counts.too_far);
  if (counts.facing_away > 0)
    text += fmt::format("            {} have no face that faces them, and are filled\n", counts.facing_away);
  text += note_lines(result.notes, 12);
  const std::string files = fmt::format("baked.glb {} {}", fmt::join(result.channels.files, " "),
                                        command.page ? "report.html " : "");
  return text + result_lines(12, result.time.total, command.out.string(), files);
}

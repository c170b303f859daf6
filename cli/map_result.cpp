#include "map_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "atlas_cache.h"
#include "format.h"
#include "map_files.h"
#include "notes.h"
#include "output_folder.h"
#include "stopwatch.h"

using Json = nlohmann::ordered_json;

namespace {

sdm::AtlasOptions atlas_options(const MapCommand& command, const sdm::Mesh& mesh) {
  sdm::AtlasOptions options = command.layout.atlas;
  if (const auto& precision = command.layout.precision)
    options.resolution = sdm::resolution_for(mesh, options, *precision);
  return options;
}

void check_sign(const MapTask& task) {
  const std::optional<sdm::Tolerance>& tolerance = task.command.picture.tolerance;
  if (!tolerance || !tolerance->needs_sign()) return;
  const sdm::SignUsed sign = sdm::choose_sign(*task.sites, task.command.map.sign);
  if (sign.method == sdm::SignMethod::none)
    throw sdm::Error(fmt::format(
        "{}: the tolerance {}:{} differs by sign, but the distances are unsigned: {}; use one number, or "
        "another --sign",
        task.to.file, tolerance->lo, tolerance->hi, sign.reason));
}

/// What map.exr says about itself.
std::vector<std::pair<std::string, std::string>> exr_attributes(const MapTask& task,
                                                                const sdm::SignUsed& sign) {
  const Input &on = task.on, &to = task.to;
  std::vector<std::pair<std::string, std::string>> attributes{{"measuredOn", on.file},
                                                              {"distanceTo", to.file},
                                                              {"sign", sign_name(sign.method)},
                                                              {"signReason", sign.reason}};
  if (!on.transform.empty()) attributes.emplace_back("measuredOnTransform", on.transform);
  if (!to.transform.empty()) attributes.emplace_back("distanceToTransform", to.transform);
  if (const std::string& units = task.command.picture.units; !units.empty())
    attributes.emplace_back("units", units);
  return attributes;
}

/// Writes all files but the report, and computes the numbers meanwhile.
void write_files(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
                 const sdm::PictureOptions& picture, const sdm::PictureOptions& fixed,
                 const std::filesystem::path& folder, Outcome& outcome) {
  const MapCommand& command = task.command;
  const sdm::Surface& surface = *computed.surface;
  const sdm::DistanceMap& map = computed.map;
  std::vector<std::uint8_t> boundary;
  if (!task.sites->closed()) {
    boundary = sdm::boundary_mask(*task.sites, map);
    outcome.boundary_texels = static_cast<std::size_t>(std::ranges::count(boundary, 1));
  }
  const sdm::ExrOptions exr{.layers = command.output.layers,
                            .boundary = boundary,
                            .sites = task.sites.get(),
                            .attributes = exr_attributes(task, map.sign)};
  sdm::run_concurrently({
      [&] {
        write_map_files(folder, command.output.files, surface, map, computed.at_vertices, &task.to.mesh,
                        picture, fixed, exr);
      },
      [&] {
        if (task.on.vertices)
          write_vertex_files(folder, command.output.files, *task.on.vertices, computed.at_vertices);
      },
      [&] {
        outcome.numbers =
            map_numbers(surface, map, outcome.distance,
                        {task.on.mesh, task.on.info->components, task.on.names, part.source_face},
                        command.bands, command.picture.tolerance, outcome.accuracy);
        outcome.error_bound = sdm::covering_radius(surface);
      },
  });
}

Notes map_notes(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
                const Outcome& outcome) {
  Notes all = notes_on(task.on, task.to);
  if (outcome.distance.texels == 0) all.push_back("no texel is within --max-distance; the map is empty");
  all.insert(all.end(), part.notes.begin(), part.notes.end());
  if (const std::size_t texels = computed.surface->overlapping_texels(); texels > 0)
    all.push_back(
        fmt::format("{} texels are covered by several faces, and have the value of one of them; --strict-uv "
                    "refuses that",
                    texels));
  if (task.aligned) std::ranges::copy(notes(*task.aligned), std::back_inserter(all));
  return all;
}

Json report_of(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
               const sdm::PictureOptions& fixed, const Outcome& outcome) {
  const MapCommand& command = task.command;
  const auto or_null = [](const auto& value) { return value ? Json(*value) : Json(nullptr); };
  const bool o1 = task.on.role == "o1";
  Json report;
  report["version"] = sdm::kVersion;
  report["o1"] = to_json(o1 ? task.on : task.to);
  report["o2"] = to_json(o1 ? task.to : task.on);
  report[task.to.role]["embedded"] = or_null(outcome.embedded);
  report["measured_on"] = task.on.role;
  report["units"] = command.picture.units;
  if (task.aligned) report["alignment"] = to_json(*task.aligned);
  report["atlas"] = to_json(*computed.surface);
  report["atlas"]["udim"] = or_null(part.udim);
  report["atlas"]["cut_faces"] = part.cut_faces;
  report["precision"] = or_null(command.layout.precision);
  report["engine"] = command.engine.name;
  report["max_distance"] = command.map.max_distance;  // null: no limit
  report["colors"] = colors_json(fixed, command.picture);
  report.update(to_json(outcome));
  return report;
}

}  // namespace

ComputedMap compute_part(MapTask& task, const AtlasPart& part) {
  const MapCommand& command = task.command;
  const sdm::Mesh& mesh = part.mesh ? *part.mesh : task.on.mesh;
  Stopwatch total;
  ComputedMap computed;
  std::unique_ptr<sdm::Surface>& surface = computed.surface;
  Outcome& outcome = computed.outcome;
  outcome.time.import = task.import_ms;

  sdm::run_concurrently({
      [&] {
        Stopwatch watch;
        surface = std::make_unique<sdm::Surface>(
            cached_surface(mesh, atlas_options(command, mesh), command.layout.cache));
        outcome.time.atlas = watch.lap();
      },
      [&] {
        Stopwatch watch;
        if (!task.sites) task.sites = std::make_unique<sdm::Sites>(task.to.mesh);
        outcome.time.sites = watch.lap();
        // The atlas leaves a core idle meanwhile. Without an inside, the answer decides nothing.
        if (sdm::choose_sign(*task.sites, command.map.sign).method == sdm::SignMethod::exact)
          outcome.embedded = sdm::is_embedded(*task.sites);
        sdm::MapOptions options = command.map;
        options.progress = nullptr;  // the atlas reports
        computed.at_vertices = sdm::distances_at_vertices(mesh, *task.sites, options);
      },
      [&] { inspect(task.on), inspect(task.to); },
  });
  check_sign(task);

  Stopwatch watch;
  sdm::DistanceMap& map = computed.map = sdm::compute_map(*surface, *task.sites, command.map);
  outcome.time.map = watch.lap();
  outcome.sign = map.sign;
  outcome.beyond_max_distance = map.beyond_max_distance;
  outcome.max_distance = command.map.max_distance;
  outcome.resolution = map.resolution, outcome.rows = map.rows();
  outcome.accuracy = sdm::engine_accuracy(sdm::engine_info(*command.map.engine), task.on.mesh, task.to.mesh);
  outcome.extremes = sdm::extremes(*surface, map, computed.at_vertices);
  outcome.raster = sdm::gl_report(*command.map.engine);
  computed.ms = total.lap();
  return computed;
}

MapResult write_part(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
                     const std::filesystem::path& folder) {
  const MapCommand& command = task.command;
  const sdm::Surface& surface = *computed.surface;
  const sdm::DistanceMap& map = computed.map;
  Stopwatch watch;
  MapResult result{.outcome = computed.outcome};
  Outcome& outcome = result.outcome;
  sdm::PictureOptions picture = command.picture;
  if (std::isfinite(outcome.accuracy)) picture.accuracy = outcome.accuracy;
  outcome.distance = sdm::statistics(surface, map);
  const sdm::PictureOptions fixed = sdm::fixed_colors(picture, outcome.distance);
  write_files(task, part, computed, picture, fixed, folder, outcome);
  if (command.picture.tolerance)
    outcome.tolerance = sdm::check_tolerance(surface, map, computed.at_vertices, outcome.error_bound,
                                             outcome.accuracy, *command.picture.tolerance);
  outcome.size = size_of(sdm::bounds(task.on.mesh));
  outcome.notes = map_notes(task, part, computed, outcome);
  outcome.time.output = watch.lap();
  outcome.time.total = outcome.time.import + computed.ms + outcome.time.output;

  result.report = report_of(task, part, computed, fixed, outcome);
  const std::string text = to_text(result.report);
  if (command.output.files.html)
    sdm::write_html(folder / "report.html", surface, map, computed.at_vertices, text,
                    {.other = &task.to.mesh, .up = command.picture.up});
  write_text(folder / "report.json", text);
  return result;
}

#include "map_result.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "atlas_cache.h"
#include "format.h"
#include "map_files.h"
#include "notes.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "weld.h"

using Json = nlohmann::ordered_json;

namespace {

sdm::AtlasOptions atlas_options(const MapCommand& command, const sdm::Mesh& mesh) {
  sdm::AtlasOptions options = command.layout.atlas;
  options.resolution = sdm::resolution_for(mesh, command.layout.fit, options);
  return options;
}

sdm::Measure measure_of(const MapCommand& command, const sdm::Progress& progress) {
  if (command.along)
    return sdm::AlongOptions{.direction = command.along->direction,
                             .max_distance = command.map.max_distance,
                             .progress = progress};
  sdm::MapOptions options = command.map;
  options.progress = progress;
  return options;
}

/// Takes the values of the vertices of islands away, which stay in files of vertices.
template <class Value>
void leave_islands_out(const Input& on, std::vector<Value>& at_vertices, Value none) {
  if (on.island_vertices.size() != at_vertices.size()) return;
  for (std::size_t v = 0; v < at_vertices.size(); ++v)
    if (on.island_vertices[v] != 0) at_vertices[v] = none;
}

/// How far both meshes may be from the surfaces that are meant.
double guard_of(const MapTask& task) {
  return task.on.deviation + task.to.deviation;
}

sdm::SummaryOptions summary_options(const MapTask& task, const AtlasPart& part, double accuracy) {
  const MapCommand& command = task.command;
  return {.units = command.picture.units,
          .max_distance = command.map.max_distance,
          .accuracy = accuracy,
          .guard = guard_of(task),
          .uncertainty = command.uncertainty,
          .tolerance = command.picture.tolerance,
          .table = command.groups.rows,
          .bands = command.bands,
          .names = task.on.names,
          .whole = &task.on.mesh,
          .whole_face = part.source_face,
          .coverage = task.coverage,
          .doubts = task.doubts,
          .accept_doubts = command.doubts.accept};
}

/// Writes all files but the report, and sums up the map meanwhile.
void write_files(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
                 const std::filesystem::path& folder, Outcome& outcome) {
  const MapCommand& command = task.command;
  const sdm::Surface& surface = *computed.surface;
  const sdm::DistanceMap& map = computed.map;
  std::vector<std::uint8_t> boundary;
  if (!task.sites->closed()) boundary = sdm::boundary_mask(*task.sites, map);
  sdm::PictureOptions picture = command.picture;
  picture.accuracy = computed.accuracy;
  std::vector<sdm::FaceNames> names;
  if (!command.groups.rows.empty()) names = sdm::names_of_part(task.on.names, part.source_face);
  if (picture.colormap == sdm::Colormap::automatic) {
    picture.table = command.groups.rows;
    picture.names = names;
  }
  const sdm::DistanceStatistics distance = sdm::statistics(surface, map);
  sdm::SummaryOptions options = summary_options(task, part, computed.accuracy);
  options.distance = &distance;
  options.boundary = boundary;
  options.colors = task.shared ? task.shared->colors : sdm::color_range(sdm::color_choice(picture), distance);
  const sdm::ExrOptions exr{.layers = command.output.layers,
                            .boundary = boundary,
                            .sites = task.sites.get(),
                            .attributes = exr_attributes(task.on, task.to, map, command.picture.units)};
  MapFiles files = command.output.files;
  // Views state the verdict, if there may be one.
  const bool judged_first = command.picture.tolerance.has_value() || !command.groups.rows.empty();
  const bool views = judged_first && std::exchange(files.views, false);
  sdm::run_concurrently({
      [&] {
        write_map_files(folder, files, surface, map, computed.at_vertices, &task.to.mesh,
                        task.shared ? task.shared->texture : picture,
                        sdm::fixed_colors(picture, *options.colors), exr);
      },
      [&] {
        if (task.on.vertices)
          write_vertex_files(folder, command.output.files, *task.on.vertices, computed.at_vertices);
      },
      [&] { outcome.summary = sdm::summarize(surface, *task.sites, map, computed.at_vertices, options); },
  });
  if (!command.groups.rows.empty()) {
    sdm::GroupVerdicts groups =
        sdm::certify_groups(surface, *task.sites, map, computed.at_vertices, names, command.groups.rows,
                            {.accuracy = computed.accuracy,
                             .doubted = !task.doubts.empty() && !command.doubts.accept,
                             .accept_doubts = command.doubts.accept,
                             .guard = guard_of(task),
                             .uncertainty = command.uncertainty});
    if (!outcome.summary.tolerance) add_group_doubts(groups, outcome.summary.doubts);
    if (!groups.groups.empty()) outcome.groups = std::move(groups);  // none is of this mesh or tile
  }
  if (!views) return;
  sdm::PictureOptions fixed = sdm::fixed_colors(picture, *options.colors);
  if (const auto verdict = judged(outcome.summary, outcome.groups)) fixed.verdict.emplace(*verdict);
  sdm::write_views_png(folder / "views.png", surface, map, computed.at_vertices, &task.to.mesh, fixed);
}

/// The kinds of names that groups with a verdict have.
std::vector<sdm::FaceNames> judged_names(const MapTask& task, const AtlasPart& part, const Outcome& outcome) {
  if (!outcome.groups) return {};
  std::vector<sdm::FaceNames> names = sdm::names_of_part(task.on.names, part.source_face);
  std::erase_if(names, [&](const sdm::FaceNames& kind) {
    return std::ranges::none_of(outcome.groups->groups,
                                [&](const sdm::GroupVerdict& g) { return g.kind == kind.kind; });
  });
  return names;
}

/// What users probably did not intend, and what a summary does not know of.
Notes all_notes(const MapTask& task, const AtlasPart& part, const sdm::Summary& summary) {
  Notes all = file_notes(task.on, task.to);
  if (auto note = note_on_unit(task.command.picture.units)) all.push_back(std::move(*note));
  std::ranges::copy(summary.notes, std::back_inserter(all));
  if (const auto note = note_on_welding(summary.sign, task.command.map.sign, task.to)) all.push_back(*note);
  std::ranges::copy(part.notes, std::back_inserter(all));
  if (task.aligned) std::ranges::copy(notes(*task.aligned), std::back_inserter(all));
  if (!task.command.picture.tolerance)
    if (auto note = note_on_unjudged(task.command.groups, task.on)) all.push_back(std::move(*note));
  return all;
}

Json report_of(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
               const Outcome& outcome) {
  const MapCommand& command = task.command;
  Json report = sdm::to_json({.on = reported(task.on),
                              .to = reported(task.to),
                              .on_o1 = task.on.role == "o1",
                              .embedded = outcome.embedded,
                              .engine = std::string(command.engine.name),
                              .precision = command.layout.fit.precision,
                              .udim = part.udim,
                              .cut_faces = part.cut_faces,
                              .time_ms = outcome.time},
                             *computed.surface, outcome.summary);
  put_fields(report, command.fields);
  for (const Input* input : {&task.on, &task.to})
    if (input->islands) report[input->role]["ignored_islands"] = to_json(*input->islands);
  if (task.aligned) report["alignment"] = to_json(*task.aligned, command.picture.units);
  if (outcome.groups) {
    report["group_tolerances"] = groups_json(*outcome.groups, outcome.summary);
    report["colors"]["by_group"] = command.picture.colormap == sdm::Colormap::automatic;
  }
  if (outcome.raster) report["raster"] = sdm::to_json(*outcome.raster);
  if (outcome.gpu) report["gpu"] = sdm::fields_json(*outcome.gpu);
  return report;
}

}  // namespace

ComputedMap compute_part(MapTask& task, const AtlasPart& part) {
  const MapCommand& command = task.command;
  const sdm::Mesh& mesh = part.mesh ? *part.mesh : task.on.mesh;
  sdm::Stopwatch total;
  ComputedMap computed;
  std::unique_ptr<sdm::Surface>& surface = computed.surface;
  Outcome& outcome = computed.outcome;
  outcome.time.import = task.import_ms;

  sdm::run_concurrently({
      [&] {
        sdm::Stopwatch watch;
        surface = std::make_unique<sdm::Surface>(
            cached_surface(mesh, atlas_options(command, mesh), command.layout.cache));
        outcome.time.atlas = watch.lap();
      },
      [&] {
        sdm::Stopwatch watch;
        if (!task.sites) task.sites = std::make_unique<sdm::Sites>(task.to.mesh);
        outcome.time.sites = watch.lap();
        // The atlas leaves a core idle meanwhile. Without an inside, the answer decides nothing.
        if (sdm::choose_sign(*task.sites, command.map).method == sdm::SignMethod::exact)
          outcome.embedded = sdm::is_embedded(*task.sites);
        // Progress is that of the atlas, which is made meanwhile.
        computed.at_vertices = sdm::distances_at_vertices(mesh, *task.sites, measure_of(command, {}));
        leave_islands_out(task.on, computed.at_vertices, std::numeric_limits<float>::quiet_NaN());
      },
      [&] {
        inspect(task.on);
        inspect(task.to);
      },
  });
  if (!command.along)
    check_sign(task.command.picture.tolerance, sdm::choose_sign(*task.sites, task.command.map), task.to);

  sdm::Stopwatch watch;
  computed.map = sdm::compute_map(*surface, *task.sites, measure_of(command, command.map.progress));
  const sdm::DistanceMap& map = computed.map;
  outcome.time.map = watch.lap();
  outcome.resolution = map.resolution;
  outcome.rows = map.rows();
  computed.accuracy = sdm::engine_accuracy(sdm::engine_info(*command.map.engine), task.on.mesh, task.to.mesh);
  if (sdm::lacks_boundary_signs(map.measured.kind, map.sign.method)) {
    std::vector<std::uint8_t> at_boundary =
        sdm::boundary_vertices(mesh, *task.sites, {.max_distance = command.map.max_distance});
    leave_islands_out(task.on, at_boundary, std::uint8_t{0});
    outcome.boundary_vertices = static_cast<std::size_t>(std::ranges::count(at_boundary, 1));
  }
  outcome.raster = sdm::gl_report(*command.map.engine);
  outcome.gpu = sdm::gpu_report(*command.map.engine);
  computed.ms = total.lap();
  return computed;
}

MapResult write_part(const MapTask& task, const AtlasPart& part, const ComputedMap& computed,
                     const std::filesystem::path& folder) {
  const MapCommand& command = task.command;
  sdm::Stopwatch watch;
  MapResult result{.outcome = computed.outcome};
  Outcome& outcome = result.outcome;
  write_files(task, part, computed, folder, outcome);
  outcome.size = size_of(sdm::bounds(task.on.mesh));
  outcome.summary.notes = all_notes(task, part, outcome.summary);
  outcome.time.output = watch.lap();
  outcome.time.total = task.import_ms + computed.ms + *outcome.time.output;

  result.report = report_of(task, part, computed, outcome);
  const std::vector<sdm::FaceNames> judged = judged_names(task, part, outcome);
  write_report(folder, command.output.files, *computed.surface, computed.map, computed.at_vertices,
               to_text(result.report),
               {.other = &task.to.mesh,
                .up = command.picture.up,
                .coverage = task.coverage ? &*task.coverage : nullptr,
                .names = judged});
  return result;
}

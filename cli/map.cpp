#include "map.h"

#include <sdm/map_files.h>

#include "alignment.h"
#include "cad_options.h"
#include "common_options.h"
#include "exit_codes.h"
#include "format.h"
#include "input_pair.h"
#include "islands.h"
#include "map_files.h"
#include "map_options.h"
#include "map_result.h"
#include "mesh_maps.h"
#include "output_folder.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "src/core/stopwatch.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAlignmentFile = "alignment.json";

/// The files that are written whatever the meshes are. UDIM tiles have folders of their own.
std::vector<std::filesystem::path> planned_files(const MapCommand& command) {
  std::vector<std::filesystem::path> files;
  if (command.align.on) files.emplace_back(kAlignmentFile);
  for (const std::filesystem::path folder : command.both ? std::vector{"o1", "o2"} : std::vector{""}) {
    if (command.layout.atlas.kind == sdm::AtlasKind::uv) continue;
    files.push_back(folder / "report.json");
    for (const std::string& name : names(command.output.files)) files.push_back(folder / name);
  }
  return files;
}

/// How much of O2 was measured, which may be a doubt.
void measure_coverage(MapTask& task, ProgressLine& progress) {
  progress.step("coverage");
  const DoubtCommand& doubts = task.command.doubts;
  const sdm::Sites measured(task.on.mesh);
  task.coverage = sdm::coverage_map(task.to.mesh, measured, reach_of(doubts, task.command.picture.tolerance),
                                    {.progress = progress.callback()});
  if (auto doubt = sdm::doubt_of(*task.coverage, *doubts.min_coverage))
    task.doubts.push_back(std::move(*doubt));
}

/// Adds the Hausdorff distance of both directions to the reports on both meshes.
void report_both_directions(std::vector<MeshMaps>& meshes, OutputFolder& out) {
  add_symmetric_hausdorff(meshes[0].whole().report, meshes[1].whole().report);
  for (const MeshMaps& mesh : meshes)
    write_text(out.staging(mesh.role + "/" + mesh.folder_of_whole()) / "report.json",
               to_text(mesh.whole().report));
}

Json report_of(const std::vector<MeshMaps>& meshes) {
  if (meshes.size() == 1) return meshes[0].report();
  return {{"o1", meshes[0].report()}, {"o2", meshes[1].report()}};
}

/// The folder of each mesh's page; of a mesh in UDIM tiles, that of its first tile.
std::vector<std::string> page_folders(const MapCommand& command, const std::vector<MeshMaps>& meshes) {
  std::vector<std::string> folders;
  for (const MeshMaps& mesh : meshes) {
    std::filesystem::path folder = command.output.folder;
    if (command.both) folder /= mesh.role;
    if (const auto& tile = mesh.parts.front().udim) folder /= std::to_string(*tile);
    folders.push_back(folder.string());
  }
  return folders;
}

std::string text_of(const MapCommand& command, const std::vector<MeshMaps>& meshes, const InputPair& pair,
                    const std::optional<AlignOutcome>& aligned, double ms) {
  std::string text;
  for (const MeshMaps& mesh : meshes) {
    const bool o1 = mesh.role == "o1";
    text += summary(mesh, o1 ? pair.o1 : pair.o2, o1 ? pair.o2 : pair.o1);
  }
  if (aligned) text += summary(*aligned, command.picture.units);
  std::vector<int> tiles;
  for (const AtlasPart& part : meshes[0].parts)
    if (part.udim) tiles.push_back(*part.udim);
  const std::string folder =
      fmt::format("{}{}{}", command.output.folder.string(), command.both ? "/{o1,o2}" : "",
                  tiles.empty() ? "" : fmt::format("/{{{}}}", fmt::join(tiles, ",")));
  const std::string files =
      (aligned && !command.both ? kAlignmentFile + std::string(" ") : "") + listed(command.output.files);
  return text + result_lines(12, ms, folder, files, page_folders(command, meshes));
}

/// Returns the exit code.
int run(MapCommand command) {
  sdm::Stopwatch total;
  limit_threads(command.threads);
  OutputFolder out(command.output.folder, {.command = "map", .planned = planned_files(command)});
  ProgressLine progress(command.quiet);
  command.layout.atlas.progress = command.map.progress = progress.callback();
  command.map.engine = make_engine(command.engine, command.gl, command.layout.atlas);

  progress.step("import");
  if (!command.groups.file.empty()) command.groups.rows = sdm::read_tolerance_table(command.groups.file);
  const bool vertices = command.output.files.any_vertices();
  command.tessellation.at_most = deflection_for(command.picture.tolerance, command.groups.rows);
  InputPair pair = load_pair(command, {.vertices = {vertices, vertices && command.both}});
  if (command.islands) pair.o1.islands = ignore_islands(pair.o1, *command.islands);
  if (command.islands_o2) pair.o2.islands = ignore_islands(pair.o2, *command.islands_o2);
  if (command.both)
    check_groups(command.groups, {&pair.o1, &pair.o2});
  else
    check_groups(command.groups, {&pair.o1});
  std::optional<AlignOutcome> aligned;
  std::vector<MeshMaps> meshes;
  out.fill([&] {
    MapTask task{command, pair.o1, pair.o2, aligned, pair.import_ms};
    const bool judged = command.picture.tolerance.has_value() || !command.groups.rows.empty();
    if (command.align.on) {
      progress.step("align");
      task.sites = std::make_unique<sdm::Sites>(pair.o2.mesh);
      command.align.judged = judged;
      aligned = align_mesh(pair.o1.mesh, *task.sites, pair.o2, command.align, progress.callback());
      write_text(out.staging() / kAlignmentFile, to_text(to_json(*aligned, command.picture.units)));
    }
    if (judged)
      task.doubts = aligned ? doubts_of(*aligned)
                            : doubts_in_place(sdm::find_other_unit_in_place(pair.o1.mesh, pair.o2.mesh));
    const std::vector<sdm::Doubt> doubts = task.doubts;
    if (command.doubts.min_coverage) measure_coverage(task, progress);
    meshes.push_back(measure_mesh(std::move(task), out, progress));
    if (!command.both) return;
    meshes.push_back(
        measure_mesh({command, pair.o2, pair.o1, aligned, pair.import_ms, doubts}, out, progress));
    report_both_directions(meshes, out);
  });

  print(
      command, [&] { return report_of(meshes); },
      [&] { return text_of(command, meshes, pair, aligned, total.lap()); });
  sdm::Verdict verdict = sdm::Verdict::pass;
  for (const MeshMaps& mesh : meshes) {
    if (const auto& tolerance = mesh.whole().outcome.summary.tolerance)
      verdict = worse(verdict, tolerance->verdict);
    for (const MapResult& map : mesh.results)
      if (map.outcome.groups) verdict = worse(verdict, map.outcome.groups->verdict);
  }
  return exit_code(verdict);
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* map = app.add_subcommand("map", "Compute the distance from every point of mesh O1 to mesh O2");
  map->footer(fmt::format(
      "Writes views.png (O1 from six sides), map.exr (all values), atlas_distance.png, atlas_voronoi.png, "
      "atlas_direction.png, model.glb (O1 in colours), report.html (a page that shows all of it) and "
      "report.json.\n"
      "{} An interrupt terminates sdm with its signal.\n\n"
      "Example, two meshes side by side:\n"
      "  sdm map bunny.obj armadillo.off -o out --transform-o1 fit --transform-o2 fit,translate:0.8:0:0",
      exit_codes()));
  const auto command = std::make_shared<MapCommand>();
  add_options(*map, *command);
  map->callback([map, command] {
    check_combination(*map, *command);
    convert_units(command->file_units, {command->o1, command->o2, command->transform_o1,
                                        command->transform_o2, command->picture.units});
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}

#include "part_map.h"

#include <utility>

#include "notes.h"
#include "src/io/json/report_json.h"
#include "unit_options.h"

void add_part_map_options(CLI::App& app, PartMapCommand& command) {
  add_resolution_option(app, command.atlas);
  add_layout_options(app, command.atlas);
  add_write_option(app, command.files, true);
  add_channels_option(app, command.layers);
  add_picture_options(app, command.picture);
  add_field_option(app, command.fields);
  add_run_options(app, command, "the report (report.json) instead of a summary");
}

void check_part_map(const PartMapCommand& command) {
  check_layout(command.atlas);
  check_units(command.picture.units, command.part.file, command.part.transform);
}

PartMap::PartMap(const Input& part, double import_ms, const sdm::AtlasOptions& atlas)
    : input(part), surface(part.mesh, atlas) {
  times.import = import_ms;
  times.atlas = watch.lap();
}

nlohmann::ordered_json write_part_map(const PartMapCommand& command, PartMap& part, const sdm::Sites& sites,
                                      sdm::Summary& summary, const std::filesystem::path& folder,
                                      const PartMapOutputs& outputs) {
  const Input& input = part.input;
  summary.notes.insert(summary.notes.begin(), input.notes.begin(), input.notes.end());
  if (auto note = note_on_unit(command.picture.units)) summary.notes.push_back(std::move(*note));
  sdm::PictureOptions fixed = sdm::fixed_colors(command.picture, *summary.colors);
  if (const auto verdict = judged(summary, {})) fixed.verdict.emplace(*verdict);
  std::vector<std::uint8_t> boundary;
  if (!sites.closed()) boundary = sdm::boundary_mask(sites, part.map);
  sdm::ExrOptions exr{.layers = command.layers,
                      .boundary = boundary,
                      .sites = &sites,
                      .attributes = exr_attributes(input, input, part.map, command.picture.units)};
  sdm::run_concurrently({[&] {
                           write_map_files(folder, command.files, part.surface, part.map, part.at_vertices,
                                           nullptr, command.picture, fixed, exr);
                         },
                         [&] { outputs.write(exr); },
                         [&] {
                           if (input.vertices)
                             write_vertex_files(folder, command.files, *input.vertices, part.at_vertices);
                         }});
  part.times.output = part.watch.lap();
  part.times.total = *part.times.import + part.total.lap();
  auto report =
      sdm::to_json({.on = reported(input), .engine = "cpu", .time_ms = part.times}, part.surface, summary);
  outputs.extend(report);
  put_fields(report, command.fields);
  write_report(folder, command.files, part.surface, part.map, part.at_vertices, to_text(report),
               outputs.page);
  return report;
}

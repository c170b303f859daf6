#include "self.h"

#include <fmt/format.h>
#include <sdm/map_files.h>
#include <sdm/measure.h>
#include <sdm/mesh_files.h>

#include "common_options.h"
#include "declared_options.h"
#include "format.h"
#include "notes.h"
#include "output_folder.h"
#include "part_map.h"
#include "print.h"
#include "progress_line.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"

#include <memory>

namespace {

using Json = nlohmann::ordered_json;

struct SelfCommand : PartMapCommand {
  sdm::SelfProximityOptions self;
};

/// Writes all files into `folder`, and returns the report.
Json measure(const SelfCommand& command, const LoadedPart& loaded, const std::filesystem::path& folder,
             ProgressLine& progress) {
  PartMap part(loaded.input, loaded.import_ms, command.atlas);
  progress.step("sites");
  sdm::SelfProximityQuery query(part.input.mesh, command.self);
  part.times.sites = part.watch.lap();
  const sdm::SelfOptions options{.exclusion = query.exclusion(),
                                 .max_distance = command.self.max_distance,
                                 .progress = command.atlas.progress};
  part.map = sdm::compute_map(part.surface, query.sites(), options);
  part.at_vertices = sdm::distances_at_vertices(part.input.mesh, query.sites(), options);
  const std::optional<sdm::BoundedLength> separation = query.separation();
  part.times.map = part.watch.lap();

  progress.step("export");
  sdm::Summary summary = sdm::summarize_self(part.surface, part.map,
                                             {.units = command.picture.units,
                                              .max_distance = command.self.max_distance,
                                              .colormap = command.picture.colormap,
                                              .range = command.picture.range});
  const auto extend = [&](Json& report) {
    const sdm::ExclusionRule& rule = command.self.exclusion;
    report["exclusion"] = {{"rings", rule.geodesic ? Json(nullptr) : Json(rule.rings)},
                           {"geodesic", rule.geodesic ? Json(*rule.geodesic) : Json(nullptr)}};
    report["settings"] = sdm::settings_json(rule, command.self);
    report["separation"] = sdm::value_json(separation);
  };
  return write_part_map(
      command, part, query.sites(), summary, folder,
      {.extend = extend, .page = {.up = command.picture.up, .places = sdm::ListedPlaces::least}});
}

std::string self_summary(const SelfCommand& command, const Json& report) {
  const std::string unit = unit_suffix(command.picture.units);
  std::string text = fmt::format("{} -> itself\n", command.part.file);
  const Json &d = report["distance"], &separation = report["separation"];
  const auto number_of = [](const Json& value) { return number(value.get<double>()); };
  if (separation.is_null())
    text += "  separation  none: all faces in range are excluded\n";
  else
    text += fmt::format("  separation  {}{} (exact)\n", number_of(separation["value"]), unit);
  if (report["texels_with_value"] == 0)
    text += "  distance    no texel has anything in range\n";
  else
    text += fmt::format("  distance    min {}   mean {}   max {}{} (of the texels)\n", number_of(d["min"]),
                        number_of(d["mean"]), number_of(d["max"]), unit);
  if (report["texels_without_value"] != 0)
    text +=
        fmt::format("              {} texels have nothing in range\n", report["texels_without_value"].dump());
  return text + note_lines(report["notes"].get<Notes>(), 14);
}

void run(SelfCommand command) {
  sdm::Stopwatch total;
  limit_threads(command.threads);
  OutputFolder out(command.out, {.command = "map", .planned = planned_files(command.files)});
  ProgressLine progress(command.quiet);
  command.atlas.progress = command.self.progress = progress.callback();

  progress.step("import");
  const LoadedPart part = load_part(command.part, command.files.any_vertices());
  Json report;
  out.fill([&] { report = measure(command, part, out.staging(), progress); });

  print(
      command, [&] { return report; },
      [&] {
        return self_summary(command, report) +
               result_lines(14, total.lap(), command.out.string(), listed(command.files));
      });
}

}  // namespace

void add_self_command(CLI::App& app) {
  CLI::App* self =
      app.add_subcommand("self", "Compute the distance from every point of a mesh to the rest of the mesh");
  self->footer(
      "Each face excludes a neighbourhood; distances are measured to all other faces.\n"
      "Writes views.png (the mesh from six sides), map.exr (all values), atlas_distance.png, "
      "atlas_voronoi.png, atlas_direction.png, model.glb, report.html and report.json.\n\n"
      "Example, distances to parts that are at least 5 away along the surface:\n"
      "  sdm self part.stl -o out --geodesic 5 --max-distance 20");
  const auto command = std::make_shared<SelfCommand>();
  SelfCommand& c = *command;
  self->add_option("MESH", c.part.file, fmt::format("The mesh ({})", sdm::mesh_format_names()))->required();
  add_output_option(*self, c.out);
  add_transform_option(*self, "--transform", "The mesh", c.part.transform);
  add_declared_options(*self, c.self.exclusion);
  add_declared_options(*self, c.self);
  add_part_map_options(*self, c);
  self->callback([command] {
    check_part_map(*command);
    run(*command);
  });
}

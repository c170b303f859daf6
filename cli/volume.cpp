#include "volume.h"

#include <fmt/format.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <memory>
#include <string>

#include "field.h"
#include "format.h"
#include "notes.h"
#include "output_folder.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"

namespace {

struct VolumeOutcome {
  sdm::DistanceField field;
  sdm::FieldReport report;
  double import_ms = 0, sites_ms = 0, output_ms = 0;
};

nlohmann::ordered_json report_of(const FieldCommand& command, const Input& o2, const VolumeOutcome& outcome) {
  const sdm::FieldReport& report = outcome.report;
  nlohmann::ordered_json json;
  json["version"] = sdm::kVersion;
  json["o2"] = to_json(o2);
  json["units"] = command.units;
  json.update(sdm::to_json(outcome.field));
  json["settings"] = sdm::settings_json(command.options);
  json["work"] = {{"field_bytes", report.field_bytes}, {"working_bytes", report.working_bytes}};
  json["notes"] = o2.notes;
  json["file"] = command.out.string();
  json["time_ms"] = {{"import", outcome.import_ms},
                     {"sites", outcome.sites_ms},
                     {"field", report.milliseconds},
                     {"output", outcome.output_ms}};
  return json;
}

std::string summary(const FieldCommand& command, const Input& o2, const VolumeOutcome& outcome) {
  return field_lines(command, outcome.field) + note_lines(o2.notes, 13) +
         fmt::format("  time       {} s\n  result     {}\n", number(outcome.report.milliseconds / 1000, 3),
                     command.out.string());
}

VolumeOutcome compute(const FieldCommand& command, Input& o2, const sdm::Progress& progress) {
  sdm::Stopwatch watch;
  VolumeOutcome outcome;
  o2 = load_input("o2", command.o2, command.transform_o2);
  if (auto note = note_on_unit(command.units)) o2.notes.push_back(std::move(*note));
  if (command.json) inspect(o2);
  outcome.import_ms = watch.lap();
  const sdm::Grid grid = grid_of(command, o2.mesh, {});
  const sdm::Sites sites(o2.mesh);
  outcome.sites_ms = watch.lap();
  sdm::FieldOptions options = command.options;
  options.progress = progress;
  outcome.field = sdm::compute_field(sites, grid, options, outcome.report);
  return outcome;
}

void run(const FieldCommand& command) {
  limit_threads(command.threads);
  OutputFolder out(std::filesystem::absolute(command.out).parent_path(),
                   {.planned = {command.out.filename()}});  // found before the field is computed
  ProgressLine progress(command.quiet);
  progress.step("import");
  Input o2;
  VolumeOutcome outcome;
  out.fill([&] {
    outcome = compute(command, o2, progress.callback());
    progress.step("output");
    sdm::Stopwatch watch;
    sdm::write_field(out.staging() / command.out.filename(), outcome.field);
    outcome.output_ms = watch.lap();
  });
  print(
      command, [&] { return report_of(command, o2, outcome); },
      [&] { return summary(command, o2, outcome); });
}

}  // namespace

void add_volume_command(CLI::App& app) {
  CLI::App* volume =
      app.add_subcommand("volume", "Compute the distance field of a mesh on a regular grid of points");
  volume->footer(
      "Distances are exact at the points of the grid.\n\n"
      "Example, a level set for other programs:\n"
      "  sdm volume part.stl --spacing 0.5 --max-distance 1.5 -o part.vdb");
  const auto command = std::make_shared<FieldCommand>();
  add_field_options(*volume, *command, "");
  volume->get_option("--output")->required();
  volume->callback([command] {
    check_field_options(*command);
    run(*command);
  });
}

#include "research/field_command.h"

#include <fmt/format.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/common_options.h"
#include "cli/field.h"
#include "cli/format.h"
#include "cli/notes.h"
#include "cli/option_checks.h"
#include "cli/output_folder.h"
#include "cli/print.h"
#include "cli/progress_line.h"
#include "cli/report.h"
#include "research/fields/fields.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"

namespace {

namespace fields = sdm::fields;
using Json = nlohmann::ordered_json;

struct Command : FieldCommand {
  std::string o1, transform_o1;
  fields::Method method = fields::Method::best;
  double tessellation = 0;
  fields::ProximityOptions proximity;
};

struct Outcome {
  fields::Field field;
  std::optional<fields::Proximity> proximity;
  Notes notes;
  double import_ms = 0, sites_ms = 0, proximity_ms = 0, output_ms = 0;
};

Json work_json(const fields::Field& field) {
  const fields::Work& work = field.work;
  return {{"sites", work.sites},
          {"pairs", work.pairs},
          {"pairs_culled", work.pairs_culled},
          {"pairs_empty", work.pairs_empty},
          {"evaluations", work.evaluations},
          {"field_bytes", field.report.field_bytes},
          {"working_bytes", field.report.working_bytes}};
}

Json proximity_json(const Command& command, const fields::Proximity& found) {
  Json json;
  json["o1"] = {{"file", command.o1}, {"transform", command.transform_o1}};
  json["separation"] = sdm::fields_json(found.separation);
  json["depth"] = found.depth ? sdm::fields_json(*found.depth) : Json(nullptr);
  json["colliding"] = Json{{"value", found.colliding}, {"kind", sdm::name_of(found.colliding_certainty)}};
  json["samples"] = found.samples;
  json["samples_without_value"] = found.without_value;
  json["covering_radius"] = found.covering_radius;
  json["error_bound"] = found.error_bound;
  return json;
}

Json report_of(const Command& command, const Input& o2, const Outcome& outcome) {
  Json json;
  json["version"] = sdm::kVersion;
  json["o2"] = to_json(o2);
  json["units"] = command.units;
  json["method"] = fields::info(command.method).name;
  json.update(sdm::to_json(outcome.field));
  json["work"] = work_json(outcome.field);
  if (outcome.proximity) json["proximity"] = proximity_json(command, *outcome.proximity);
  json["notes"] = outcome.notes;
  json["file"] = command.out.empty() ? Json(nullptr) : Json(command.out.string());
  json["time_ms"] = {{"import", outcome.import_ms},
                     {"sites", outcome.sites_ms},
                     {"field", outcome.field.report.milliseconds},
                     {"sign", outcome.field.work.sign_milliseconds},
                     {"proximity", outcome.proximity_ms},
                     {"output", outcome.output_ms}};
  return json;
}

std::string length_line(const char* what, const sdm::BoundedLength& d, const std::string& unit) {
  return fmt::format("  {:<11}{}{}   between {} and {} ({})\n", what, number(d.value), unit, number(d.lower),
                     number(d.upper), sdm::name_of(d.certainty));
}

std::string summary(const Command& command, const Outcome& outcome) {
  const std::string unit = unit_suffix(command.units);
  std::string text = field_lines(command, outcome.field);
  if (const auto& p = outcome.proximity) {
    text += fmt::format("{} to {}, at {} samples\n", command.o1, command.o2, p->samples);
    text += length_line("separation", p->separation, unit);
    if (p->depth) text += length_line("depth", *p->depth, unit);
    text += fmt::format("  colliding  {} ({})\n", p->colliding ? "yes" : "no",
                        sdm::name_of(p->colliding_certainty));
  }
  text += note_lines(outcome.notes, 13);
  const double ms = outcome.field.report.milliseconds + outcome.field.work.sign_milliseconds;
  text += fmt::format("  time       {} s by {}\n", number(ms / 1000, 3), fields::info(command.method).name);
  if (!command.out.empty()) text += fmt::format("  result     {}\n", command.out.string());
  return text;
}

Outcome compute(const Command& command, Input& o2, const sdm::Progress& progress) {
  sdm::Stopwatch watch;
  Outcome outcome;
  o2 = load_input("o2", command.o2, command.transform_o2);
  Input o1;
  if (!command.o1.empty()) o1 = load_input("o1", command.o1, command.transform_o1);
  outcome.notes = command.o1.empty() ? o2.notes : notes_on(o1, o2);
  if (command.json) inspect(o2);
  outcome.import_ms = watch.lap();
  const sdm::Grid grid = grid_of(command, o2.mesh, sdm::bounds(o1.mesh));
  const sdm::Sites sites(o2.mesh);
  outcome.sites_ms = watch.lap();
  outcome.field = fields::compute_field(sites, grid,
                                        {.method = command.method,
                                         .sign = command.options.sign,
                                         .max_distance = command.options.max_distance,
                                         .sites = command.options.sites,
                                         .tessellation = command.tessellation,
                                         .progress = progress});
  watch.lap();
  if (!command.o1.empty()) {
    fields::ProximityOptions samples = command.proximity;
    samples.progress = progress;
    outcome.proximity = fields::proximity(outcome.field, o1.mesh, samples);
    outcome.proximity_ms = watch.lap();
  }
  return outcome;
}

void run(const Command& command) {
  limit_threads(command.threads);
  std::optional<OutputFolder> out;  // found before the field is computed
  if (!command.out.empty())
    out.emplace(std::filesystem::absolute(command.out).parent_path(),
                OutputFiles{.planned = {command.out.filename()}});
  ProgressLine progress(command.quiet);
  progress.step("import");
  Input o2;
  Outcome outcome;
  const auto work = [&] {
    outcome = compute(command, o2, progress.callback());
    if (!out) return;
    progress.step("output");
    sdm::Stopwatch watch;
    sdm::write_field(out->staging() / command.out.filename(), outcome.field);
    outcome.output_ms = watch.lap();
  };
  if (out)
    out->fill(work);
  else
    work();
  print(
      command, [&] { return report_of(command, o2, outcome); }, [&] { return summary(command, outcome); });
}

void check(const Command& command, const CLI::App& app) {
  const fields::MethodInfo& method = fields::info(command.method);
  if (method.needs_max_distance && command.options.max_distance == std::numeric_limits<double>::infinity())
    throw CLI::ValidationError("--method", fmt::format("{} needs --max-distance", method.name));
  if (command.tessellation > 0 && command.method != fields::Method::brute_force)
    throw CLI::ValidationError("--tessellation", "requires --method brute_force");
  if (command.out.empty() && command.o1.empty())
    throw CLI::ValidationError("--output", "give a file with -o, or a mesh with --proximity");
  if (command.o1.empty() && (app.count("--transform-o1") > 0 || app.count("--sample-spacing") > 0))
    throw CLI::ValidationError("--proximity", "is required by --transform-o1 and --sample-spacing");
  check_field_options(command);
}

}  // namespace

void add_field_command(CLI::App& app) {
  CLI::App* field = app.add_subcommand(
      "field", "Compute a distance field by a method of the literature, or proximity from a field");
  field->footer(
      "Without --tessellation, distances are exact at the points of the grid, by every method: `best` is "
      "that "
      "of sdm volume, and `reference` is for verification.\n\n"
      "Example:\n"
      "  sdm-paper field part.stl --spacing 0.5 --method difi -o part.vti");
  const auto command = std::make_shared<Command>();
  Command& c = *command;
  add_field_options(*field, c, ", and around O1 of --proximity");
  std::vector<std::pair<std::string, fields::Method>> methods;
  for (const fields::MethodInfo& method : fields::methods()) methods.emplace_back(method.name, method.method);
  add_choice<fields::Method>(*field, "--method", c.method,
                             "How distances are computed, with the same result by all", methods);
  field
      ->add_option("--tessellation", c.tessellation,
                   "brute_force: draw distance functions as meshes with an error of at most E, as in the "
                   "literature, instead of evaluating them at each point; unsigned")
      ->check(positive_number())
      ->type_name("E");
  field
      ->add_option(
          "--proximity", c.o1,
          "A mesh whose separation from O2 and depth in it are estimated from the field, with bounds")
      ->type_name("O1");
  field
      ->add_option("--sample-spacing", c.proximity.sample_spacing,
                   "The most that samples of O1 are apart; by default the smallest spacing of the grid")
      ->check(positive_number())
      ->type_name("S");
  add_transform_option(*field, "--transform-o1", "O1", c.transform_o1);
  field->callback([command, field] {
    check(*command, *field);
    run(*command);
  });
}

#include "volume.h"

#include <fmt/format.h>
#include <sdm/field_files.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common_options.h"
#include "format.h"
#include "notes.h"
#include "option_checks.h"
#include "output_folder.h"
#include "progress_line.h"
#include "proximity_report.h"
#include "report.h"
#include "stopwatch.h"

namespace {

using Json = nlohmann::ordered_json;

struct VolumeCommand {
  std::string o2, transform_o2, o1, transform_o1, units;
  std::vector<std::uint32_t> points;  // along x, y and z
  double spacing = 0;
  std::vector<double> bounds;  // low and high corner
  sdm::FieldOptions options;
  sdm::FieldProximityOptions proximity;
  std::filesystem::path out;
  unsigned threads = 0;
  bool json = false, quiet = false;
};

struct VolumeOutcome {
  sdm::DistanceField field;
  std::optional<sdm::FieldProximity> proximity;
  Notes notes;
  double min = std::numeric_limits<double>::quiet_NaN(), max = min;  // of the points with a value
  double import_ms = 0, sites_ms = 0, proximity_ms = 0, output_ms = 0;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void extend(sdm::Box& box, const sdm::Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.lo[k] = std::min(box.lo[k], other.lo[k]);
    box.hi[k] = std::max(box.hi[k], other.hi[k]);
  }
}

// The default grid extends around O2 by the band, or by a tenth of O2's diagonal, and around O1.
sdm::Grid grid_of(const VolumeCommand& command, const sdm::Mesh& o2, const sdm::Mesh& o1) {
  sdm::Box box;
  if (!command.bounds.empty()) {
    for (std::size_t k = 0; k < 3; ++k) box.lo[k] = command.bounds[k], box.hi[k] = command.bounds[k + 3];
  } else {
    box = sdm::bounds(o2);
    const double diagonal = std::hypot(box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]);
    const double margin = command.options.band < kInfinity ? command.options.band : 0.1 * diagonal;
    for (std::size_t k = 0; k < 3; ++k) box.lo[k] -= margin, box.hi[k] += margin;
    extend(box, sdm::bounds(o1));
  }
  if (command.points.empty()) return sdm::make_grid(box, command.spacing);
  return sdm::make_grid(box, {command.points[0], command.points[1], command.points[2]});
}

void find_range(VolumeOutcome& outcome) {
  for (const float d : outcome.field.distance) {
    if (std::isnan(d)) continue;
    outcome.min = std::isnan(outcome.min) ? double{d} : std::min(outcome.min, double{d});
    outcome.max = std::isnan(outcome.max) ? double{d} : std::max(outcome.max, double{d});
  }
}

Json field_json(const VolumeOutcome& outcome) {
  const sdm::DistanceField& f = outcome.field;
  const sdm::FieldReport& work = f.report;
  Json json;
  json["grid"] = {{"points", f.grid.dims}, {"origin", f.grid.origin}, {"spacing", f.grid.spacing}};
  json["method"] = sdm::field_method(work.method).name;
  json["band"] = f.band;  // null: no limit
  json["sign"] = {{"method", sign_name(f.sign.method)}, {"reason", f.sign.reason}};
  json["distance"] = {{"min", outcome.min}, {"max", outcome.max}};  // null: no point has a value
  json["beyond_band"] = f.beyond_band;
  json["accuracy"] = f.accuracy;
  json["accuracy_kind"] = "bounded";
  json["work"] = {{"sites", work.sites},
                  {"pairs", work.pairs},
                  {"pairs_culled", work.pairs_culled},
                  {"pairs_empty", work.pairs_empty},
                  {"evaluations", work.evaluations},
                  {"field_bytes", work.field_bytes},
                  {"working_bytes", work.working_bytes}};
  return json;
}

Json proximity_json(const VolumeCommand& command, const sdm::FieldProximity& found) {
  Json json;
  json["o1"] = {{"file", command.o1}, {"transform", command.transform_o1}};
  json["separation"] = to_json(found.separation);
  json["depth"] = found.depth ? to_json(*found.depth) : Json(nullptr);
  json["colliding"] = to_json(found.colliding);
  json["samples"] = found.samples;
  json["samples_without_value"] = found.without_value;
  json["covering_radius"] = found.covering_radius;
  json["error_bound"] = found.error_bound;
  return json;
}

Json report_of(const VolumeCommand& command, const Input& o2, const VolumeOutcome& outcome) {
  Json json;
  json["version"] = sdm::kVersion;
  json["o2"] = to_json(o2);
  json["units"] = command.units;
  json.update(field_json(outcome));
  if (outcome.proximity) json["proximity"] = proximity_json(command, *outcome.proximity);
  json["notes"] = outcome.notes;
  json["file"] = command.out.empty() ? Json(nullptr) : Json(command.out.string());
  json["time_ms"] = {{"import", outcome.import_ms},
                     {"sites", outcome.sites_ms},
                     {"field", outcome.field.report.milliseconds},
                     {"sign", outcome.field.report.sign_milliseconds},
                     {"proximity", outcome.proximity_ms},
                     {"output", outcome.output_ms}};
  return json;
}

std::string length_line(const char* what, const sdm::BoundedLength& d, const std::string& unit) {
  return fmt::format("  {:<11}{}{}   between {} and {} ({})\n", what, number(d.value), unit, number(d.lower),
                     number(d.upper), name(d.certainty));
}

std::string summary(const VolumeCommand& command, const VolumeOutcome& outcome) {
  const std::string unit = unit_suffix(command.units);
  const sdm::DistanceField& f = outcome.field;
  std::string text = fmt::format("{}\n  grid       {} x {} x {} points, {} {} {}{} apart\n", command.o2,
                                 f.grid.dims[0], f.grid.dims[1], f.grid.dims[2], number(f.grid.spacing[0]),
                                 number(f.grid.spacing[1]), number(f.grid.spacing[2]), unit);
  if (f.beyond_band == f.distance.size())
    text += "  distance   no point is within the band\n";
  else
    text += fmt::format("  distance   min {}   max {}{}, to {}\n", number(outcome.min), number(outcome.max),
                        unit, number(f.accuracy, 2));
  if (f.sign.method == sdm::SignMethod::none)
    text += fmt::format("             unsigned: {}\n", f.sign.reason);
  if (f.beyond_band > 0) text += fmt::format("             {} points are beyond the band\n", f.beyond_band);
  if (const auto& p = outcome.proximity) {
    text += fmt::format("{} to {}, at {} samples\n", command.o1, command.o2, p->samples);
    text += length_line("separation", p->separation, unit);
    if (p->depth) text += length_line("depth", *p->depth, unit);
    text += fmt::format("  colliding  {} ({})\n", p->colliding.value ? "yes" : "no",
                        name(p->colliding.certainty));
  }
  text += note_lines(outcome.notes, 13);
  text += fmt::format("  time       {} s by {}\n",
                      number((f.report.milliseconds + f.report.sign_milliseconds) / 1000, 3),
                      sdm::field_method(f.report.method).name);
  if (!command.out.empty()) text += fmt::format("  result     {}\n", command.out.string());
  return text;
}

VolumeOutcome compute(const VolumeCommand& command, Input& o2, const sdm::Progress& progress) {
  Stopwatch watch;
  VolumeOutcome outcome;
  o2 = load_input("o2", command.o2, command.transform_o2);
  Input o1;
  if (!command.o1.empty()) o1 = load_input("o1", command.o1, command.transform_o1);
  outcome.notes = command.o1.empty() ? o2.notes : notes_on(o1, o2);
  if (command.json) inspect(o2);
  outcome.import_ms = watch.lap();
  const sdm::Grid grid = grid_of(command, o2.mesh, o1.mesh);
  const sdm::Sites sites(o2.mesh);
  outcome.sites_ms = watch.lap();
  sdm::FieldOptions options = command.options;
  options.progress = progress;
  outcome.field = sdm::compute_field(sites, grid, options);
  find_range(outcome);
  watch.lap();
  if (!command.o1.empty()) {
    sdm::FieldProximityOptions samples = command.proximity;
    samples.progress = progress;
    outcome.proximity = sdm::field_proximity(outcome.field, o1.mesh, samples);
    outcome.proximity_ms = watch.lap();
  }
  return outcome;
}

void run(const VolumeCommand& command) {
  limit_threads(command.threads);
  std::optional<OutputFolder> out;  // found before the field is computed
  if (!command.out.empty()) out.emplace(std::filesystem::absolute(command.out).parent_path());
  ProgressLine progress(command.quiet);
  progress.step("import");
  Input o2;
  VolumeOutcome outcome;
  const auto work = [&] {
    outcome = compute(command, o2, progress.callback());
    if (!out) return;
    progress.step("output");
    Stopwatch watch;
    sdm::write_field(out->staging() / command.out.filename(), outcome.field);
    outcome.output_ms = watch.lap();
  };
  if (out)
    out->fill(work);
  else
    work();
  if (command.json)
    std::cout << to_text(report_of(command, o2, outcome));
  else if (!command.quiet)
    std::cout << summary(command, outcome);
}

void check(const VolumeCommand& command, const CLI::App& app) {
  if (command.points.empty() == (command.spacing == 0))
    throw CLI::ValidationError("--grid", "give either --grid or --spacing");
  for (std::size_t k = 0; k < 3 && !command.bounds.empty(); ++k)
    if (!(command.bounds[k] <= command.bounds[k + 3]))
      throw CLI::ValidationError("--bounds", "the first three numbers are the lowest coordinates");
  if (sdm::field_method(command.options.method).needs_band && command.options.band == kInfinity)
    throw CLI::ValidationError(
        "--method", fmt::format("{} needs --band", sdm::field_method(command.options.method).name));
  if (command.options.tessellation > 0 && command.options.method != sdm::FieldMethod::brute_force)
    throw CLI::ValidationError("--tessellation", "requires --method brute_force");
  if (command.out.empty() && command.o1.empty())
    throw CLI::ValidationError("--output", "give a file with -o, or a mesh with --proximity");
  if (command.o1.empty() && (app.count("--transform-o1") > 0 || app.count("--sample-spacing") > 0))
    throw CLI::ValidationError("--proximity", "is required by --transform-o1 and --sample-spacing");
  if (command.out.empty()) return;
  try {
    sdm::check_field_format(command.out);
  } catch (const sdm::Error& error) {
    throw CLI::ValidationError("--output", error.what());
  }
}

}  // namespace

void add_volume_command(CLI::App& app) {
  CLI::App* volume =
      app.add_subcommand("volume", "Compute the distance field of a mesh on a regular grid of points");
  volume->footer(
      "Without --tessellation, distances are exact at the points of the grid, by every method: `best` is the "
      "fastest one; the others are those of the literature, for comparison, and `reference` is for "
      "verification.\n\n"
      "Example, a level set for other programs:\n"
      "  sdm volume part.stl --spacing 0.5 --band 1.5 -o part.vdb");
  const auto command = std::make_shared<VolumeCommand>();
  VolumeCommand& c = *command;
  volume
      ->add_option("O2", c.o2,
                   fmt::format("The mesh that distances are measured to ({})", sdm::mesh_format_names()))
      ->required();
  volume->add_option("-o,--output", c.out, "The file: " + sdm::field_format_names())->type_name("FILE");
  volume->add_option("--grid", c.points, "Points along x, y and z")
      ->expected(3)
      ->transform(whole_number(1, sdm::Grid::kMostPoints))
      ->type_name("NX NY NZ");
  volume
      ->add_option("--spacing", c.spacing,
                   "The distance of neighbouring points along each axis, in place of --grid")
      ->check(number("a positive number", [](double x) { return x > 0; }))
      ->type_name("H");
  volume
      ->add_option("--bounds", c.bounds,
                   "The lowest and the highest corner of the grid; by default the box of O2, extended by the "
                   "band, or by a tenth of its diagonal, and around O1 of --proximity")
      ->expected(6)
      ->check(number("a number", [](double) { return true; }))
      ->type_name("X0 Y0 Z0 X1 Y1 Z1");
  volume->add_option("--band", c.options.band, "Points farther from O2 than D have no value")
      ->check(number("a positive number", [](double x) { return x > 0; }))
      ->type_name("D");
  add_sign_option(*volume, c.options.sign);
  std::vector<std::pair<std::string, sdm::FieldMethod>> methods;
  for (const sdm::FieldMethodInfo& method : sdm::field_methods())
    methods.emplace_back(method.name, method.method);
  add_choice<sdm::FieldMethod>(*volume, "--method", c.options.method,
                               "How distances are computed, with the same result by all", methods);
  volume
      ->add_option("--tessellation", c.options.tessellation,
                   "brute_force: draw distance functions as meshes with an error of at most E, as in the "
                   "literature, instead of evaluating them at each point; unsigned")
      ->check(number("a positive number", [](double x) { return x > 0; }))
      ->type_name("E");
  volume->add_flag("--sites", c.options.sites, "Also find the closest sites (in .vti)");
  volume
      ->add_option(
          "--proximity", c.o1,
          "A mesh whose separation from O2 and depth in it are estimated from the field, with bounds")
      ->type_name("O1");
  volume
      ->add_option("--sample-spacing", c.proximity.sample_spacing,
                   "The most that samples of O1 are apart; by default the smallest spacing of the grid")
      ->check(number("a positive number", [](double x) { return x > 0; }))
      ->type_name("S");
  add_transform_option(*volume, "--transform-o1", "O1", c.transform_o1);
  add_transform_option(*volume, "--transform-o2", "O2", c.transform_o2);
  volume->add_option("--units", c.units, "Units of the meshes, for printed values")->type_name("NAME");
  add_run_options(*volume, c.threads, c.json, c.quiet, "JSON instead of a summary");
  volume->callback([command, volume] {
    check(*command, *volume);
    run(*command);
  });
}

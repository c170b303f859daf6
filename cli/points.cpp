#include "points.h"

#include <sdm/map_files.h>
#include <sdm/points.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cad_options.h"
#include "declared_options.h"
#include "exit_codes.h"
#include "format.h"
#include "islands.h"
#include "map_files.h"
#include "notes.h"
#include "output_folder.h"
#include "points_report.h"
#include "print.h"
#include "progress_line.h"
#include "src/core/stopwatch.h"
#include "src/io/mesh/placement.h"
#include "weld.h"

namespace {

using Json = nlohmann::ordered_json;

// How much of O2 was measured, by up to 2^20 of the points, which may be a doubt.
void measure_cloud_coverage(const PointsCommand& command, const sdm::Transform& placement,
                            const sdm::CloudIslands* islands, const sdm::Mesh& o2, PointsOutcome& outcome,
                            ProgressLine& progress) {
  constexpr std::size_t kSample = std::size_t{1} << 20;
  progress.step("coverage");
  sdm::PointSample sample =
      sdm::sample_points(command.cloud, kSample, {command.text, progress.callback(), islands});
  if (sample.points.empty()) return;
  sdm::transform(sample.points, placement);
  outcome.coverage = sdm::coverage_map(o2, sample.points, reach_of(command.doubts, command.picture.tolerance),
                                       {.progress = progress.callback()});
  outcome.summary.coverage = *outcome.coverage;
  if (auto doubt = sdm::doubt_of(*outcome.coverage, *command.doubts.min_coverage))
    outcome.summary.doubts.push_back(std::move(*doubt));
}

// The alignment of a sample of the points, after their placement.
AlignOutcome align_sample(const PointsCommand& command, const sdm::Transform& placement,
                          const sdm::CloudIslands* islands, const sdm::Sites& sites, const Input& o2,
                          const sdm::Progress& progress) {
  constexpr std::size_t kSample = 1 << 18;
  sdm::PointSample sample = sdm::sample_points(command.cloud, kSample, {command.text, progress, islands});
  if (sample.points.empty())
    throw sdm::Error(command.cloud + ": there are no points with coordinates" +
                     (islands ? " that are of no island" : ""));
  sdm::transform(sample.points, placement);
  for (sdm::Vec3& n : sample.normals) n = placement.normal(n);
  return align_points(sample.points, sample.normals, sites, o2, command.align, progress);
}

// The first points of the file decide; `box` is that of all. A placement may have changed their size.
std::optional<std::string> precision_note(const PointsCommand& command, const sdm::Box& box) {
  if (!command.transform_o1.empty()) return std::nullopt;
  constexpr std::size_t kFirst = 1 << 16;
  sdm::PointSample first;
  sdm::PointReader(command.cloud, command.text).read(kFirst, first.points, first.normals);
  return note_on_precision(command.cloud, first.points, size_of(box));
}

/// What users probably did not intend.
void add_notes(const PointsCommand& command, const Input& o2, PointsOutcome& outcome) {
  Notes& all = outcome.summary.notes;
  const sdm::Box& box = outcome.found.bounds;
  if (const auto note = precision_note(command, box)) all.push_back(*note);
  std::ranges::copy(o2.notes, std::back_inserter(all));
  if (auto note = note_on_unit(command.picture.units)) all.push_back(std::move(*note));
  if (const auto note = note_on_islands(command.cloud, outcome.found)) all.push_back(*note);
  if (const auto note = note_on_welding(outcome.found.sign, command.map.sign, o2)) all.push_back(*note);
  std::ranges::copy(sdm::notes_on(box, sdm::bounds(o2.mesh)), std::back_inserter(all));
  if (outcome.aligned) std::ranges::copy(notes(*outcome.aligned), std::back_inserter(all));
  if (!command.picture.tolerance)
    if (auto note = note_on_unjudged(command.groups, o2)) all.push_back(std::move(*note));
}

std::string files(const PointsCommand& command) {
  return fmt::format("{}{}{}", command.align.on ? "alignment.json " : "", command.ply ? "points.ply " : "",
                     command.html ? "report.html " : "");
}

std::vector<std::filesystem::path> planned_files(const PointsCommand& command) {
  std::vector<std::filesystem::path> planned{"report.json"};
  if (command.align.on) planned.emplace_back("alignment.json");
  if (command.ply) planned.emplace_back("points.ply");
  if (command.html) planned.emplace_back("report.html");
  return planned;
}

// The mesh that is measured to, and the tolerances of its groups.
Input load_reference(PointsCommand& command) {
  if (!command.groups.file.empty()) command.groups.rows = sdm::read_tolerance_table(command.groups.file);
  command.tessellation.at_most = deflection_for(command.picture.tolerance, command.groups.rows);
  Input o2 = load_input("o2", command.o2, command.transform_o2, {.tessellation = command.tessellation});
  check_deflection(command.tessellation, {&o2});
  if (command.weld) weld(o2, *command.weld);
  if (command.islands_o2) o2.islands = ignore_islands(o2, *command.islands_o2);
  check_groups(command.groups, {&o2});
  return o2;
}

sdm::PointDistancesOptions measuring_options(const PointsCommand& command, const Input& o2) {
  return {.map = command.map,
          .along = command.along,
          .placement = sdm::io::transform_of(sdm::io::parse_placement(command.transform_o1)),
          .picture = command.picture,
          .text = command.text,
          .names = o2.names,
          .table = command.groups.rows,
          .guard = o2.deviation,
          .uncertainty = command.uncertainty,
          .accept_doubts = command.doubts.accept};
}

// Aligns the points, which changes their placement, and writes alignment.json.
void align_cloud(PointsCommand& command, const sdm::Sites& sites, const Input& o2,
                 const std::filesystem::path& folder, sdm::PointDistancesOptions& options,
                 PointsOutcome& outcome, ProgressLine& progress) {
  progress.step("align");
  command.align.judged = command.picture.tolerance.has_value() || !command.groups.rows.empty();
  outcome.aligned = align_sample(command, options.placement, options.islands, sites, o2, progress.callback());
  options.placement = outcome.aligned->alignment.transform * options.placement;
  write_text(folder / "alignment.json", to_text(to_json(*outcome.aligned, command.picture.units)));
}

void add(std::vector<sdm::Doubt>& doubts, const std::vector<sdm::Doubt>& more) {
  doubts.insert(doubts.end(), more.begin(), more.end());
}

// A cloud that is in place may be in another unit. It is read again only if its size is that of another unit.
void doubt_unit(const PointsCommand& command, const sdm::PointDistancesOptions& options, const sdm::Mesh& o2,
                PointsOutcome& outcome, ProgressLine& progress) {
  const bool judged = command.picture.tolerance.has_value() || !command.groups.rows.empty();
  if (!judged || !sdm::sizes_differ(outcome.found.bounds, sdm::bounds(o2))) return;
  constexpr std::size_t kSample = std::size_t{1} << 18;
  sdm::PointSample sample =
      sdm::sample_points(command.cloud, kSample, {command.text, progress.callback(), options.islands});
  sdm::transform(sample.points, options.placement);
  add(outcome.summary.doubts, doubts_in_place(sdm::find_other_unit_in_place(sample.points, o2)));
}

// Withholds a PASS where there are doubts.
void judge_doubts(const PointsCommand& command, const sdm::PointDistancesOptions& options, const Input& o2,
                  PointsOutcome& outcome, ProgressLine& progress) {
  if (outcome.aligned && command.align.judged) add(outcome.summary.doubts, doubts_of(*outcome.aligned));
  if (!outcome.aligned) doubt_unit(command, options, o2.mesh, outcome, progress);
  if (command.doubts.min_coverage)
    measure_cloud_coverage(command, options.placement, options.islands, o2.mesh, outcome, progress);
  sdm::withhold_pass(outcome.summary, command.doubts.accept);
  if (outcome.found.groups && !outcome.summary.doubts.empty() && !command.doubts.accept)
    sdm::withhold_pass(*outcome.found.groups);
}

/// Returns the exit code.
int run(PointsCommand command) {
  sdm::Stopwatch total, watch;
  limit_threads(command.threads);
  OutputFolder out(command.out, {.command = "points", .planned = planned_files(command)});
  ProgressLine progress(command.quiet);
  command.map.progress = progress.callback();

  progress.step("import");
  Input o2 = load_reference(command);
  sdm::PointDistancesOptions options = measuring_options(command, o2);
  PointsOutcome outcome;
  Json report;
  out.fill([&] {
    const sdm::Sites sites(o2.mesh);
    inspect(o2);
    if (!command.along) check_sign(command.picture.tolerance, sdm::choose_sign(sites, command.map), o2);
    std::optional<sdm::CloudIslands> islands;
    if (command.island_points > 0) {
      islands.emplace(command.cloud, command.island_points,
                      sdm::CloudIslandsOptions{.text = command.text, .progress = progress.callback()});
      options.islands = &*islands;
    }
    outcome.import_ms = watch.lap();
    if (command.align.on) align_cloud(command, sites, o2, out.staging(), options, outcome, progress);
    outcome.align_ms = watch.lap();
    const std::filesystem::path ply = out.staging() / "points.ply";
    outcome.found = sdm::measure_points(command.cloud, sites, ply, options);
    outcome.summary = sdm::summarize(outcome.found, options);
    if (!outcome.summary.tolerance && outcome.found.groups)
      add_group_doubts(*outcome.found.groups, outcome.summary.doubts);
    judge_doubts(command, options, o2, outcome, progress);
    add_notes(command, o2, outcome);
    outcome.points_ms = watch.lap();
    report = report_of(command, o2, outcome);
    if (command.html) {
      progress.step("page");
      sdm::write_points_html(out.staging() / "report.html", ply, outcome.found, to_text(report),
                             {.other = &o2.mesh,
                              .up = command.picture.up,
                              .coverage = outcome.coverage ? &*outcome.coverage : nullptr});
    }
    if (!command.ply) std::filesystem::remove(ply);
    write_text(out.staging() / "report.json", to_text(report));
  });

  print(
      command, [&] { return report; },
      [&] {
        return text_of(command, outcome) +
               result_lines(12, total.lap(), command.out.string(), files(command));
      });
  return outcome.code();
}

void add_files_option(CLI::App& app, PointsCommand& command) {
  std::vector<std::string> choices{"ply"};
  std::string help = "The files to write: ply: points.ply; ";
  if (sdm::can_write_html()) {
    choices.emplace_back("html");
    help += "html: report.html, a page that shows the cloud; ";
  }
  add_write_option(app, choices, choices, help + "or none",
                   [&command](const std::vector<std::string>& chosen) {
                     command.ply = std::ranges::count(chosen, "ply") > 0;
                     command.html = std::ranges::count(chosen, "html") > 0;
                   });
}

/// What options do not allow together.
void check_points_options(const PointsCommand& command) {
  try {
    sdm::validate(command.text);
  } catch (const sdm::Error& fault) {
    throw CLI::ValidationError("--columns", fault.what());
  }
  if (const auto& t = command.picture.tolerance;
      t && std::max(std::abs(t->lower), std::abs(t->upper)) > command.map.max_distance)
    throw CLI::ValidationError("--tolerance",
                               "must not be greater than --max-distance, beyond which points have no value");
  check_doubts(command.doubts, command.picture.tolerance);
  check_uncertainty(command.uncertainty,
                    command.picture.tolerance.has_value() || !command.groups.file.empty());
}

}  // namespace

void add_points_command(CLI::App& app) {
  CLI::App* points =
      app.add_subcommand("points", "Compute the distance from every point of a cloud to a mesh");
  points->footer(fmt::format(
      "Writes points.ply (the points in their order, with distance, closest face and colours), report.html "
      "(a page that shows the cloud) and report.json.\n"
      "Clouds of any size are read in parts.\n"
      "{}\n\n"
      "Example:\n"
      "  sdm points scan.ply part.stl -o out --align --tolerance 0.1 --units mm",
      exit_codes()));
  const auto command = std::make_shared<PointsCommand>();
  PointsCommand& c = *command;
  points->add_option("CLOUD", c.cloud, fmt::format("The point cloud ({})", sdm::point_format_names()))
      ->required();
  add_declared_options(*points, c.text);
  points
      ->add_option("O2", c.o2,
                   fmt::format("The mesh that distances are measured to ({})", sdm::mesh_format_names()))
      ->required();
  add_output_option(*points, c.out);
  add_transform_option(*points, "--transform-o1", "The cloud (without fit)", c.transform_o1);
  add_transform_option(*points, "--transform-o2", "O2", c.transform_o2);
  add_unit_options(*points, c.file_units);
  add_weld_option(*points, c.weld, "O2");
  add_point_island_option(*points, c.island_points);
  add_island_option_o2(*points, c.islands_o2);
  add_deflection_option(*points, c.tessellation);
  add_align_options(*points, c.align);
  add_declared_options(*points, c.map);
  add_along_option(*points, c.along, "Along a direction, points without normals are measured to any face.");
  add_tolerance_option(*points, c.picture.tolerance);
  add_tolerance_table_option(
      *points, c.groups,
      "Judge the points by groups of O2, those of their closest faces, by the exit code "
      "too");
  add_uncertainty_option(*points, c.uncertainty);
  add_doubt_options(*points, c.doubts);
  add_color_options(*points, c.picture);
  add_units_option(*points, c.picture.units);
  add_files_option(*points, c);
  add_up_option(*points, c.picture.up, "The axis of the meshes that points up, in report.html.");
  add_field_option(*points, c.fields);
  add_run_options(*points, c, "the report (report.json) instead of a summary");
  points->callback([command, points] {
    check_points_options(*command);
    convert_units(command->file_units, {command->cloud, command->o2, command->transform_o1,
                                        command->transform_o2, command->picture.units});
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}

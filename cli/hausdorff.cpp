#include "hausdorff.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "bounds_text.h"
#include "cad_options.h"
#include "common_options.h"
#include "declared_options.h"
#include "doubts.h"
#include "exit_codes.h"
#include "format.h"
#include "input_pair.h"
#include "notes.h"
#include "option_checks.h"
#include "print.h"
#include "progress_line.h"
#include "report.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "unit_options.h"

namespace {

using Json = nlohmann::ordered_json;

struct HausdorffCommand : PairFiles, RunOptions {
  std::string units;
  sdm::HausdorffOptions options;
  bool both = false;
  std::optional<double> tolerance;
  double uncertainty = 0;
  bool accept_doubts = false;
};

/// The distance that was asked for, and those in single directions as far as they were computed.
struct HausdorffAnswer {
  sdm::HausdorffDistance distance;
  int from = 0;  ///< the mesh, 0 or 1, that the witness starts on
  std::vector<sdm::HausdorffDistance> directions{};
  double size = 0;  ///< of the smaller mesh, for the digits of places
  Notes notes{};
  std::vector<sdm::Doubt> doubts{};
  double guard = 0;  ///< how far the meshes may be from the surfaces that are meant, and the uncertainty
};

HausdorffAnswer measure(const std::vector<sdm::Sites>& sites, const sdm::Mesh& o1,
                        const sdm::HausdorffOptions& options) {
  if (sites.size() == 1) {
    const sdm::HausdorffDistance d = sdm::one_sided_hausdorff(o1, sites[0], options);
    return {.distance = d, .directions = {d}};
  }
  const sdm::SymmetricHausdorff both = sdm::symmetric_hausdorff(sites[0], sites[1], options);
  return {
      .distance = both.larger, .from = both.larger_from, .directions = {both.from.begin(), both.from.end()}};
}

struct HausdorffVerdict {
  bool within = true;      // as far as the bounds tell
  bool certified = true;   // by both bounds
  bool unmatched = false;  // not within, as there are faces without a distance
  bool doubted = false;    // a PASS is withheld

  [[nodiscard]] sdm::Verdict word() const {
    if (!certified) return sdm::Verdict::not_decided;
    if (!within) return sdm::Verdict::fail;
    return doubted ? sdm::Verdict::doubtful : sdm::Verdict::pass;
  }
};

HausdorffVerdict verdict(const HausdorffAnswer& answer, const HausdorffCommand& command) {
  const double tolerance = *command.tolerance;
  const sdm::BoundedLength& d = answer.distance.distance;
  const bool unmatched =
      std::ranges::any_of(answer.directions, [](const auto& h) { return h.faces_without_match > 0; });
  if (unmatched) return {.within = false, .unmatched = true};
  return {.within = d.lower <= tolerance + answer.guard,
          .certified = d.lower > tolerance + answer.guard || d.upper <= tolerance - answer.guard,
          .doubted = !answer.doubts.empty() && !command.accept_doubts};
}

/// Computes the distance, with closer bounds if the tolerance is between them.
HausdorffAnswer decide(const std::vector<sdm::Sites>& sites, const sdm::Mesh& o1,
                       const HausdorffCommand& command, double guard, const sdm::Progress& progress) {
  constexpr double kCloser = 1e-3;
  sdm::HausdorffOptions options = command.options;
  options.progress = progress;
  const auto measured = [&] {
    HausdorffAnswer answer = measure(sites, o1, options);
    answer.guard = guard;
    return answer;
  };
  HausdorffAnswer answer = measured();
  while (command.tolerance && !verdict(answer, command).certified) {
    const sdm::BoundedLength& d = answer.distance.distance;
    const double gap = d.upper - d.lower;
    const bool in_guard_band = d.lower > *command.tolerance - guard && d.upper <= *command.tolerance + guard;
    if (!(gap > 0) || in_guard_band) break;
    options.precision = kCloser * gap;
    const HausdorffAnswer closer = measured();
    if (!(closer.distance.distance.upper - closer.distance.distance.lower < 0.5 * gap)) break;  // rounding
    answer = closer;
  }
  return answer;
}

sdm::DecisionRule rule_of(const HausdorffCommand& command) {
  return command.uncertainty > 0 ? sdm::DecisionRule::iso_14253_1 : sdm::DecisionRule::simple_acceptance;
}

std::string distance_line(const std::string& what, const sdm::HausdorffDistance& h, const std::string& unit) {
  const sdm::BoundedLength& d = h.distance;
  constexpr int kDigits = 9;
  const std::string bounds =
      d.certainty == sdm::Certainty::bounded ? "   " + bounds_text(d.lower, d.upper, kDigits) : std::string();
  return fmt::format("  {:<11}{}{}{} ({})\n", what, number(d.value, kDigits), unit, bounds,
                     sdm::name_of(d.certainty));
}

/// States the faces that are left out.
std::string unmatched_lines(const HausdorffAnswer& answer) {
  std::string text;
  for (std::size_t i = 0; i < answer.directions.size(); ++i) {
    const sdm::HausdorffDistance& h = answer.directions[i];
    if (h.faces_without_match == 0) continue;
    text += fmt::format(
        "             left out: {} faces of O{}, {} % of its area, as no face of O{} faces as they do\n",
        h.faces_without_match, i + 1, number(100 * h.area_without_match, 3), 2 - i);
  }
  return text;
}

std::string tolerance_line(const HausdorffVerdict& v, const HausdorffCommand& command, double guard,
                           const std::string& unit) {
  const std::string limit = number(*command.tolerance) + unit;
  const std::string by = sdm::uncertainty_text(command.uncertainty, command.units);
  return fmt::format(
      "  tolerance  {}: {}\n", sdm::name_of(v.word()),
      v.unmatched                 ? "faces without a match have no distance"
      : !v.certified && guard > 0 ? fmt::format("the distance is closer to {} than the guard band, {}{}",
                                                limit, number(guard, 2), unit)
      : !v.certified              ? fmt::format("the distance is {}, to the precision", limit)
      : v.within ? fmt::format("no point is farther than {}{}{}", limit, by.empty() ? "" : ",", by)
                 : fmt::format("a point is farther than {}{}", limit, by));
}

std::string hausdorff_summary(const HausdorffCommand& command, const HausdorffAnswer& answer) {
  const std::string unit = unit_suffix(command.units);
  std::string text = fmt::format("{} -> {}\n", command.o1, command.o2);
  if (command.both) text = fmt::format("{}, {}\n", command.o1, command.o2);
  if (command.options.facing)
    text += fmt::format("  measured   {}\n", sdm::measured_distance({.facing = command.options.facing}).text);
  text += distance_line("hausdorff", answer.distance, unit);
  const auto& [p, q] = *answer.distance.distance.witness;
  const char* const names[2] = {"O1", "O2"};
  text += fmt::format("             from {} of {}, face {}, to {} of {}, face {}\n", place(p, answer.size),
                      names[answer.from], answer.distance.faces[0], place(q, answer.size),
                      names[1 - answer.from], answer.distance.faces[1]);
  if (command.both) {
    text += distance_line("O1 -> O2", answer.directions[0], unit);
    text += distance_line("O2 -> O1", answer.directions[1], unit);
  }
  text += unmatched_lines(answer);
  if (command.tolerance) text += tolerance_line(verdict(answer, command), command, answer.guard, unit);
  return text + doubt_lines(answer.doubts, 13);
}

Json report_of(const HausdorffCommand& command, const InputPair& pair, const HausdorffAnswer& answer) {
  Json json = report_on(pair, command.units);
  const bool facing = command.options.facing.has_value();
  if (facing) json["facing"] = *command.options.facing;
  json["hausdorff"] = to_json(answer.distance);
  json["from"] = answer.from == 0 ? "o1" : "o2";
  json["o1_to_o2"] = to_json(answer.directions[0], facing);
  json["o2_to_o1"] = command.both ? to_json(answer.directions[1], facing) : Json(nullptr);
  if (command.tolerance) {
    const HausdorffVerdict v = verdict(answer, command);
    json["tolerance"] = {{"value", *command.tolerance},
                         {"verdict", sdm::name_of(v.word())},
                         {"within", v.within},
                         {"certified", v.certified},
                         {"guard", answer.guard},
                         {"uncertainty", command.uncertainty},
                         {"decision_rule", name_of(rule_of(command))}};
  }
  json["settings"] = sdm::settings_json(command.options);
  json["doubts"] = sdm::to_json(answer.doubts);
  json["notes"] = answer.notes;
  return json;
}

/// Returns the exit code.
int run(const HausdorffCommand& command) {
  limit_threads(command.threads);
  ProgressLine progress(command.quiet);
  progress.step("import");
  PairFiles files = command;
  if (command.tolerance) files.tessellation.at_most = deflection_for(*command.tolerance);
  const InputPair pair = load_pair(files, {.inspects = command.json});
  sdm::Stopwatch watch;
  std::vector<sdm::Sites> sites;  // of the meshes that distances are measured to: O2, or both
  if (command.both) sites.emplace_back(pair.o1.mesh);
  sites.emplace_back(pair.o2.mesh);
  const double build_ms = watch.lap();
  HausdorffAnswer answer =
      decide(sites, pair.o1.mesh, command, pair.o1.deviation + pair.o2.deviation + command.uncertainty,
             progress.callback());
  answer.size = smaller_size(pair);
  answer.notes = notes_on(pair.o1, pair.o2);
  if (auto note = note_on_unit(command.units)) answer.notes.push_back(std::move(*note));
  if (command.options.facing)
    for (const Input* input : {&pair.o1, &pair.o2})
      if (input == &pair.o1 || command.both)
        if (auto note = sdm::note_on_directions(input->mesh, *command.options.facing, command.units))
          answer.notes.push_back(std::move(*note));
  if (command.tolerance && !command.options.facing)
    if (auto note = sdm::note_on_walls(sites.back(), *command.tolerance, command.units))
      answer.notes.push_back(std::move(*note));
  if (command.tolerance && verdict(answer, command).word() == sdm::Verdict::pass)
    answer.doubts = doubts_in_place(sdm::find_other_unit_in_place(pair.o1.mesh, pair.o2.mesh));
  const double query_ms = watch.lap();

  const auto report = [&] {
    Json json = report_of(command, pair, answer);
    json["time_ms"] = {{"import", pair.import_ms}, {"build", build_ms}, {"query", query_ms}};
    return json;
  };
  print(command, report, [&] { return hausdorff_summary(command, answer) + note_lines(answer.notes, 13); });
  if (!command.tolerance) return kSuccess;
  return exit_code(verdict(answer, command).word());
}

}  // namespace

void add_hausdorff_command(CLI::App& app) {
  CLI::App* hausdorff =
      app.add_subcommand("hausdorff", "Compute the Hausdorff distance of two meshes, with certified bounds");
  hausdorff->footer(fmt::format(
      "The largest distance from a point of the surface of O1 to the surface of O2, or with --both the "
      "larger one of both directions. Nothing is sampled: the bounds hold for all points.\n"
      "{}\n\n"
      "Example:\n"
      "  sdm hausdorff simplified.ply original.ply --both --tolerance 0.1",
      exit_codes()));
  const auto command = std::make_shared<HausdorffCommand>();
  HausdorffCommand& c = *command;
  add_pair_arguments(*hausdorff, c,
                     {fmt::format("The mesh whose points are measured ({})", sdm::mesh_format_names()),
                      "The mesh that distances are measured to"});
  add_pair_transforms(*hausdorff, c);
  add_pair_reading(*hausdorff, c);
  add_declared_options(*hausdorff, c.options);
  hausdorff->add_flag("--both", c.both, "Measure in both directions");
  hausdorff
      ->add_option(
          "--tolerance", c.tolerance,
          "Judge whether the distance is at most T, by the exit code too; closer bounds are computed if T is "
          "between them")
      ->check(no_negative_number())
      ->type_name("T");
  add_uncertainty_option(*hausdorff, c.uncertainty);
  add_accept_doubts(*hausdorff, c.accept_doubts,
                    "PASS stays PASS where O1 seems to be in another unit, instead of DOUBTFUL.");
  add_units_option(*hausdorff, c.units);
  add_run_options(*hausdorff, c, "JSON instead of a summary");
  hausdorff->callback([command] {
    check_units(command->units, command->o1, command->transform_o1);
    check_units(command->units, command->o2, command->transform_o2);
    check_uncertainty(command->uncertainty, command->tolerance.has_value());
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}

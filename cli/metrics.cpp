#include "metrics.h"

#include <fmt/format.h>
#include <sdm/mesh_files.h>
#include <sdm/metrics.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <memory>

#include "bounds_text.h"
#include "common_options.h"
#include "declared_options.h"
#include "exit_codes.h"
#include "format.h"
#include "input_pair.h"
#include "metric_conditions.h"
#include "notes.h"
#include "print.h"
#include "progress_line.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "unit_options.h"

namespace {

using Json = nlohmann::ordered_json;

struct MetricsCommand : PairFiles, RunOptions {
  std::string units;
  sdm::MetricsOptions options;
  std::vector<MetricCondition> conditions;
};

struct MetricsAnswer {
  sdm::SurfaceMetrics metrics;
  std::vector<sdm::NamedMetric> named;
  std::vector<sdm::Verdict> verdicts;  ///< of the conditions
  Notes notes;

  [[nodiscard]] sdm::Verdict verdict() const {
    sdm::Verdict all = sdm::Verdict::pass;
    for (const sdm::Verdict v : verdicts) all = worse(all, v);
    return all;
  }
};

MetricsAnswer measure_metrics(const InputPair& pair, const MetricsCommand& command,
                              const sdm::MetricsOptions& options) {
  MetricsAnswer answer;
  answer.metrics = sdm::surface_metrics(pair.o1.mesh, pair.o2.mesh, options);
  answer.named = sdm::named_metrics(answer.metrics, options);
  for (const MetricCondition& condition : command.conditions)
    answer.verdicts.push_back(judge(condition, answer.named));
  return answer;
}

/// Asks for closer bounds of what is not decided.
void tighten(const MetricsCommand& command, const MetricsAnswer& answer, sdm::MetricsOptions& options) {
  constexpr double kCloser = 0.1;
  for (std::size_t i = 0; i < command.conditions.size(); ++i) {
    if (answer.verdicts[i] != sdm::Verdict::not_decided) continue;
    const sdm::NamedMetric& m =
        *std::ranges::find(answer.named, command.conditions[i].name, &sdm::NamedMetric::name);
    const double closer = kCloser * (m.number.upper - m.number.lower);
    double& precision = m.unit == sdm::MetricUnit::fraction
                            ? options.fraction_precision
                            : options.precision.emplace(options.precision.value_or(closer));
    precision = std::min(precision, closer);
  }
}

/// Computes the measures, with closer bounds if a limit is between them.
MetricsAnswer decide_metrics(const InputPair& pair, const MetricsCommand& command,
                             const sdm::Progress& progress) {
  constexpr int kMostTries = 3;
  sdm::MetricsOptions options = command.options;
  options.progress = progress;
  MetricsAnswer answer = measure_metrics(pair, command, options);
  for (int n = 0; n < kMostTries && answer.verdict() == sdm::Verdict::not_decided; ++n) {
    tighten(command, answer, options);
    options.progress = [&](std::string_view, double fraction) { return progress("closer bounds", fraction); };
    answer = measure_metrics(pair, command, options);
  }
  return answer;
}

Json metrics_report(const MetricsCommand& command, const InputPair& pair, const MetricsAnswer& answer) {
  Json json = report_on(pair, command.units);
  json.update(sdm::to_json(answer.metrics, command.options));
  if (!command.conditions.empty()) {
    json["verdict"] = sdm::name_of(answer.verdict());
    json["fail_if"] = Json::array();
    for (std::size_t i = 0; i < command.conditions.size(); ++i)
      json["fail_if"].push_back(
          {{"text", command.conditions[i].text}, {"verdict", sdm::name_of(answer.verdicts[i])}});
  }
  json["settings"] = sdm::settings_json(command.options);
  json["notes"] = answer.notes;
  return json;
}

std::string unit_of(const sdm::NamedMetric& metric, const std::string& units) {
  if (metric.unit == sdm::MetricUnit::fraction || units.empty()) return {};
  return unit_suffix(metric.unit == sdm::MetricUnit::area ? units + "²" : units);
}

std::string metrics_summary(const MetricsCommand& command, const MetricsAnswer& answer) {
  constexpr int kDigits = 6;
  std::size_t width = 0;
  for (const sdm::NamedMetric& m : answer.named) width = std::max(width, m.name.size());
  std::string text = fmt::format("{}, {}\n", command.o1, command.o2);
  for (std::size_t i = 0; i < command.conditions.size(); ++i)
    text += fmt::format("  {:<{}}  {}: {}\n", "fail if", width, command.conditions[i].text,
                        sdm::name_of(answer.verdicts[i]));
  for (const sdm::NamedMetric& m : answer.named) {
    const sdm::BoundedNumber& n = m.number;
    std::string bounds;
    if (n.certainty == sdm::Certainty::bounded || m.confidence)
      bounds = "   " + bounds_text(n.lower, n.upper, kDigits);
    if (m.confidence) bounds += fmt::format(", {} %", 100 * *m.confidence);
    text += fmt::format("  {:<{}}  {}{}{} ({})\n", m.name, width, number(n.value, kDigits),
                        unit_of(m, command.units), bounds, sdm::name_of(n.certainty));
  }
  if (command.options.estimate)
    text += fmt::format(
        "  from {} and {} random points of O1 and O2; {} % hold for each number, not for all at once\n",
        answer.metrics.from[0].points, answer.metrics.from[1].points, 100 * answer.metrics.confidence);
  return text;
}

/// Returns the exit code.
int run(const MetricsCommand& command) {
  limit_threads(command.threads);
  ProgressLine progress(command.quiet);
  progress.step("import");
  const InputPair pair = load_pair(command, {.inspects = command.json});
  sdm::Stopwatch watch;
  MetricsAnswer answer = decide_metrics(pair, command, progress.callback());
  answer.notes = notes_on(pair.o1, pair.o2);
  if (auto note = note_on_unit(command.units)) answer.notes.push_back(std::move(*note));
  const double query_ms = watch.lap();
  const auto report = [&] {
    Json json = metrics_report(command, pair, answer);
    json["time_ms"] = {{"import", pair.import_ms}, {"query", query_ms}};
    return json;
  };
  print(command, report, [&] { return metrics_summary(command, answer) + note_lines(answer.notes, 13); });
  return exit_code(answer.verdict());
}

void remove_duplicates(std::vector<double>& numbers) {
  std::vector<double> once;
  for (const double x : numbers)
    if (std::ranges::find(once, x) == once.end()) once.push_back(x);
  numbers = once;
}

}  // namespace

void add_metrics_command(CLI::App& app) {
  CLI::App* metrics = app.add_subcommand(
      "metrics", "Compare two surfaces by average, percentile and tolerance measures, with certified bounds");
  metrics->footer(fmt::format(
      "The measures that papers and benchmarks report, of all points of both surfaces, weighted by area: "
      "nothing is sampled, unless --estimate is given. hd: Hausdorff distance; hd95: its 95th percentile; "
      "assd, masd, rmsd: average surface distances; chamfer_l1, chamfer_l2; nsd(T): surface Dice; "
      "precision(T), recall(T), f_score(T), where O2 is the truth; normal_consistency, an estimate.\n"
      "{}\n\n"
      "Example:\n"
      "  sdm metrics prediction.ply truth.ply --tolerance 1 --fail-if 'hd95>2' --fail-if 'nsd(1)<0.95'",
      exit_codes()));
  const auto command = std::make_shared<MetricsCommand>();
  const auto conditions = std::make_shared<std::vector<std::string>>();
  MetricsCommand& c = *command;
  add_pair_arguments(*metrics, c,
                     {fmt::format("The mesh that is compared ({})", sdm::mesh_format_names()),
                      "The mesh that it is compared with, the truth"});
  add_pair_transforms(*metrics, c);
  add_pair_reading(*metrics, c);
  add_declared_options(
      *metrics, c.options, {"fraction_precision"},
      {{"percentiles", "Percentiles P for hdP, separated by commas.", "percentile"},
       {"tolerances", "Distances T for nsd(T), precision(T), recall(T) and f_score(T), separated by commas.",
        "tolerance"}});
  metrics
      ->add_option("--fail-if", *conditions,
                   "A condition such as 'hd95>0.5' or 'nsd(1)<0.95', quoted, under which the comparison "
                   "fails, by the exit code too; several may be given")
      ->allow_extra_args(false)
      ->excludes(metrics->get_option("--estimate"))
      ->type_name("CONDITION");
  add_units_option(*metrics, c.units);
  add_run_options(*metrics, c, "JSON instead of a summary");
  metrics->callback([command, conditions] {
    check_units(command->units, command->o1, command->transform_o1);
    check_units(command->units, command->o2, command->transform_o2);
    for (std::vector<double>* numbers : {&command->options.percentiles, &command->options.tolerances})
      remove_duplicates(*numbers);
    for (const std::string& text : *conditions)
      command->conditions.push_back(parse_metric_condition(text, command->options));
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}

#include "metric_conditions.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "option_checks.h"

namespace {

constexpr std::string_view kPlain[] = {
    "hd", "assd", "masd", "rmsd", "chamfer_l1", "chamfer_l2", "normal_consistency"};
constexpr std::string_view kOfTolerance[] = {"nsd", "precision", "recall", "f_score"};

void add_to(std::vector<double>& numbers, double number) {
  if (std::ranges::find(numbers, number) == numbers.end()) numbers.push_back(number);
}

/// The name as sdm::named_metrics() spells it, after adding what it asks for to the options.
std::optional<std::string> known_name(std::string_view name, sdm::MetricsOptions& options) {
  if (std::ranges::find(kPlain, name) != std::end(kPlain)) return std::string(name);
  if (name.starts_with("hd")) {
    const auto percent = parse_number(name.substr(2));
    if (!percent || !(*percent > 0 && *percent < 100)) return std::nullopt;
    add_to(options.percentiles, *percent);
    return sdm::percentile_name(*percent);
  }
  const std::size_t open = name.find('(');
  if (open == std::string_view::npos || !name.ends_with(')')) return std::nullopt;
  const std::string_view kind = name.substr(0, open);
  const auto tolerance = parse_number(name.substr(open + 1, name.size() - open - 2));
  if (std::ranges::find(kOfTolerance, kind) == std::end(kOfTolerance) || !tolerance || *tolerance < 0)
    return std::nullopt;
  add_to(options.tolerances, *tolerance);
  return sdm::metric_name(kind, *tolerance);
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

}  // namespace

MetricCondition parse_metric_condition(const std::string& text, sdm::MetricsOptions& options) {
  const std::size_t at = text.find_first_of("<>");
  const auto fault = [&](const std::string& what) {
    return CLI::ValidationError(fmt::format("--fail-if: \"{}\" {}", text, what));
  };
  if (at == std::string::npos) throw fault("has no comparison: write NAME>X or NAME<X, such as hd95>0.5");
  const bool or_equal = text.substr(at + 1).starts_with('=');
  const auto limit = parse_number(trimmed(std::string_view(text).substr(at + (or_equal ? 2 : 1))));
  if (!limit) throw fault("does not end with a number");
  const std::string_view name = trimmed(std::string_view(text).substr(0, at));
  const auto known = known_name(name, options);
  if (!known)
    throw fault(fmt::format(
        "names no measure: \"{}\" is not hd, hdP, assd, masd, rmsd, chamfer_l1, chamfer_l2, nsd(T), "
        "precision(T), recall(T), f_score(T) or normal_consistency",
        name));
  return {text, *known, text[at] == '>', or_equal, *limit};
}

sdm::Verdict judge(const MetricCondition& condition, const std::vector<sdm::NamedMetric>& metrics) {
  const auto found = std::ranges::find(metrics, condition.name, &sdm::NamedMetric::name);
  if (found == metrics.end()) throw std::logic_error("there is no measure " + condition.name);
  const sdm::BoundedNumber& number = found->number;
  const auto holds = [&](double x) {
    if (x == condition.limit) return condition.or_equal;
    return condition.above ? x > condition.limit : x < condition.limit;
  };
  // Rounding exceeds no limit.
  if (number.certainty == sdm::Certainty::exact && number.lower <= condition.limit &&
      condition.limit <= number.upper)
    return condition.or_equal ? sdm::Verdict::fail : sdm::Verdict::pass;
  const bool of_lower = holds(number.lower), of_upper = holds(number.upper);
  if (of_lower != of_upper) return sdm::Verdict::not_decided;
  return of_lower ? sdm::Verdict::fail : sdm::Verdict::pass;
}

// Conditions on measures, such as hd95>0.5, under which a comparison fails.
#pragma once

#include <sdm/metrics.h>
#include <sdm/tolerance.h>

#include <string>
#include <vector>

/// One of --fail-if: a measure by its name, a comparison and a number.
struct MetricCondition {
  std::string text;  ///< as it was given
  std::string name;  ///< as NamedMetric::name
  bool above = true;
  bool or_equal = false;
  double limit = 0;
};

/// Reads NAME>X, NAME>=X, NAME<X or NAME<=X, and adds the percentile or tolerance of the name to the options,
/// unless they have it. Throws CLI::ValidationError, naming the text, if it is none or there is no such
/// measure.
[[nodiscard]] MetricCondition parse_metric_condition(const std::string& text, sdm::MetricsOptions& options);

/// Whether the condition holds, which fails: decided where all numbers within the bounds agree; of an
/// estimate, by its value.
[[nodiscard]] sdm::Verdict judge(const MetricCondition& condition,
                                 const std::vector<sdm::NamedMetric>& metrics);

#include "doubts.h"

#include <sdm/summary.h>

#include <algorithm>
#include <cmath>

#include "declared_options.h"
#include "option_checks.h"

void add_accept_doubts(CLI::App& app, bool& accept, const char* text) {
  add_declared_option(app, sdm::option_of(&sdm::SummaryOptions::accept_doubts), accept,
                      {"accept_doubts", text});
}

void add_uncertainty_option(CLI::App& app, double& uncertainty) {
  add_declared_option(app, sdm::option_of(&sdm::SummaryOptions::uncertainty), uncertainty);
}

void check_uncertainty(double uncertainty, bool judged) {
  if (uncertainty > 0 && !judged)
    throw CLI::ValidationError("--uncertainty", "needs limits, which it keeps away from");
}

void add_doubt_options(CLI::App& app, DoubtCommand& command) {
  add_accept_doubts(app, command.accept);
  CLI::Option* least = app.add_option("--min-coverage", command.min_coverage,
                                      "Measure which fraction of O2's area has a measured point near it (by "
                                      "--reach D) and doubt a PASS if "
                                      "it is below F; 0 only measures it")
                           ->check(number("a number from 0 to 1", [](double x) { return x >= 0 && x <= 1; }))
                           ->type_name("F");
  app.add_option("--reach", command.reach, "That reach; by default the larger limit of the tolerance")
      ->check(positive_number())
      ->type_name("D")
      ->needs(least);
}

double reach_of(const DoubtCommand& command, const std::optional<sdm::Tolerance>& tolerance) {
  if (command.reach) return *command.reach;
  return tolerance ? std::max(std::abs(tolerance->lower), std::abs(tolerance->upper)) : 0;
}

void check_doubts(const DoubtCommand& command, const std::optional<sdm::Tolerance>& tolerance) {
  if (command.min_coverage && !(reach_of(command, tolerance) > 0))
    throw CLI::ValidationError("--min-coverage", "needs --reach, or a tolerance other than 0");
}

std::vector<sdm::Doubt> doubts_in_place(const std::optional<sdm::OtherUnit>& unit) {
  if (!unit) return {};
  return {sdm::doubt_of(*unit)};
}

// Doubts that make a PASS doubtful, and how they are overruled.
#pragma once

#include <sdm/doubts.h>
#include <sdm/tolerance.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <vector>

struct DoubtCommand {
  bool accept = false;
  std::optional<double> min_coverage{};
  std::optional<double> reach{};  ///< of a measured point; by default the larger limit of the tolerance
};

/// Adds --accept-doubts; `text`: its help, if other doubts are left than the declared ones.
void add_accept_doubts(CLI::App& app, bool& accept, const char* text = nullptr);

/// Adds --uncertainty.
void add_uncertainty_option(CLI::App& app, double& uncertainty);
/// Throws CLI::ValidationError for an uncertainty where nothing is `judged`.
void check_uncertainty(double uncertainty, bool judged);

/// Adds --accept-doubts, --min-coverage and --reach.
void add_doubt_options(CLI::App& app, DoubtCommand& command);

/// Throws CLI::ValidationError if there is a least coverage, but no reach.
void check_doubts(const DoubtCommand& command, const std::optional<sdm::Tolerance>& tolerance);

/// The doubt about an O1 that is not aligned, of sdm::find_other_unit_in_place(); none without a unit.
[[nodiscard]] std::vector<sdm::Doubt> doubts_in_place(const std::optional<sdm::OtherUnit>& unit);

/// The value of the key `doubts` of reports, and its inverse.

/// The reach of a measured point.
[[nodiscard]] double reach_of(const DoubtCommand& command, const std::optional<sdm::Tolerance>& tolerance);

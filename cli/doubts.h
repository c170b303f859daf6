// Doubts that make a PASS doubtful, and how they are overruled.
#pragma once

#include <sdm/doubts.h>
#include <sdm/tolerance.h>

#include <CLI/CLI.hpp>
#include <optional>

struct DoubtCommand {
  bool accept = false;
  std::optional<double> min_coverage{};
  std::optional<double> reach{};  ///< of a measured point; by default the larger limit of the tolerance
};

/// Adds --accept-doubts, --min-coverage and --reach.
void add_doubt_options(CLI::App& app, DoubtCommand& command);

/// Throws CLI::ValidationError if there is a least coverage, but no reach.
void check_doubts(const DoubtCommand& command, const std::optional<sdm::Tolerance>& tolerance);

/// The reach of a measured point.
[[nodiscard]] double reach_of(const DoubtCommand& command, const std::optional<sdm::Tolerance>& tolerance);

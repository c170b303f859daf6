// The command line of commands about the proximity of two bodies.
#pragma once

#include <sdm/proximity_query.h>

#include <CLI/CLI.hpp>
#include <array>
#include <string>

#include "common_options.h"
#include "input_pair.h"

struct PairCommand : PairFiles, RunOptions {
  std::string units;
  sdm::ProximityOptions options;
};

/// The options set `command`, which must outlive the parsing. `bodies` describes O1 and O2 in the help text.
void add_options(CLI::App& app, PairCommand& command, const std::array<std::string, 2>& bodies);

// The command line of commands about the proximity of two bodies.
#pragma once

#include <sdm/proximity_query.h>

#include <CLI/CLI.hpp>
#include <array>
#include <string>

struct PairCommand {
  std::string o1, o2, transform_o1, transform_o2, units;
  sdm::ProximityOptions options;
  unsigned threads = 0;
  bool json = false, quiet = false;
};

/// The options set `command`, which must outlive the parsing. `bodies` describes O1 and O2 in the help text.
void add_options(CLI::App& app, PairCommand& command, const std::array<std::string, 2>& bodies);

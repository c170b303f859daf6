// `sdm map`: from two mesh files to a folder of results.
#pragma once

#include <CLI/CLI.hpp>

/// Ends with CLI::RuntimeError(3) if a tolerance is exceeded.
void add_map_command(CLI::App& app);

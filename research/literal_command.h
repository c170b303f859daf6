// `sdm-paper literal`: the paper's algorithm as it is printed.
#pragma once

#include <CLI/CLI.hpp>

void add_literal_command(CLI::App& app);

// `sdm simplify`.
#pragma once

#include <CLI/CLI.hpp>

void add_simplify_command(CLI::App& app);

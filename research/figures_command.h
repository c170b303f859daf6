// `sdm-paper figures`: the figures and tables of the paper, computed again.
#pragma once

#include <CLI/CLI.hpp>

void add_figures_command(CLI::App& app);

#pragma once

#include <CLI/CLI.hpp>

/// sdm paper: re-runs the figures and tables of the paper.
void add_paper_command(CLI::App& app);

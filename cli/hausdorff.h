// `sdm hausdorff`.
#pragma once

#include <CLI/CLI.hpp>

void add_hausdorff_command(CLI::App& app);

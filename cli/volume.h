// `sdm volume`: the distance field of a mesh on a grid.
#pragma once

#include <CLI/CLI.hpp>

void add_volume_command(CLI::App& app);

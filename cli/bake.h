// `sdm bake`: from a detailed mesh and a coarse one to textures of the coarse one.
#pragma once

#include <CLI/CLI.hpp>

void add_bake_command(CLI::App& app);

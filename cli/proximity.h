// `sdm proximity`.
#pragma once

#include <CLI/CLI.hpp>

void add_proximity_command(CLI::App& app);

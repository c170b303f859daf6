// `sdm bodies`.
#pragma once

#include <CLI/CLI.hpp>

void add_bodies_command(CLI::App& app);

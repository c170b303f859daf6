// `sdm self`: from a mesh file to a folder of results about its distance to itself.
#pragma once

#include <CLI/CLI.hpp>

void add_self_command(CLI::App& app);

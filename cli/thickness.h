// `sdm thickness`: from a mesh file to a folder of results about the thickness of its walls.
#pragma once

#include <CLI/CLI.hpp>

void add_thickness_command(CLI::App& app);

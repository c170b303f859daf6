// `sdm scene`: the paper's scenes as files.
#pragma once

#include <CLI/CLI.hpp>

void add_scene_command(CLI::App& app);

// `sdm sequence`.
#pragma once

#include <CLI/CLI.hpp>

void add_sequence_command(CLI::App& app);

// The subcommand `metrics`.
#pragma once

#include <CLI/CLI.hpp>

void add_metrics_command(CLI::App& app);

// `sdm-paper field`: distance fields by the methods of the literature, and proximity from a field.
#pragma once

#include <CLI/CLI.hpp>

void add_field_command(CLI::App& app);

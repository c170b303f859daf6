// --along: distances along a line.
#pragma once

#include <sdm/along.h>

#include <CLI/CLI.hpp>
#include <optional>

/// Adds --along, which sets `along`.
void add_along_option(CLI::App& app, std::optional<sdm::AlongOptions>& along);
/// Throws CLI::ValidationError for options that distances along lines do not have.
void check_along(const CLI::App& app, const std::optional<sdm::AlongOptions>& along);

// --along: distances along a line.
#pragma once

#include <sdm/along.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

/// Adds --along, which sets `along`; `sample`: what has the normal, for the help text, and `remark`, its end.
void add_along_option(CLI::App& app, std::optional<sdm::AlongOptions>& along, const std::string& sample,
                      const std::string& remark);
/// Throws CLI::ValidationError for options that distances along lines do not have.
void check_along(const CLI::App& app, const std::optional<sdm::AlongOptions>& along);

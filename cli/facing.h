// --facing: distances to the faces that face the samples.
#pragma once

#include <sdm/map.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

/// Adds --facing; `sample`: what has the normal, and `other`: the other mesh, for the help text.
void add_facing_option(CLI::App& app, std::optional<double>& facing, const std::string& sample,
                       const std::string& other = "O2");

/// Throws CLI::ValidationError for a --sign that such distances do not have.
void check_facing(const sdm::MapOptions& options);

// --deflection: how closely the triangles of CAD files follow their surfaces.
#pragma once

#include <sdm/tessellation.h>

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "report.h"

/// Adds --deflection.
void add_deflection_option(CLI::App& app, sdm::TessellationOptions& options);

/// Throws CLI::ValidationError if a deflection was given but none of the inputs is CAD.
void check_deflection(const sdm::TessellationOptions& options, std::initializer_list<const Input*> inputs);

/// What `sdm info` prints: names and values.
[[nodiscard]] std::vector<std::pair<const char*, std::string>> rows_of(const sdm::Tessellation& tessellation);

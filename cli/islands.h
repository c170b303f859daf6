// --ignore-islands: small components of O1 are left out.
#pragma once

#include <sdm/islands.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "report.h"

/// Adds --ignore-islands.
void add_island_option(CLI::App& app, std::optional<sdm::IslandLimits>& limits);

/// Removes the islands of an input, which was not inspected, and notes how many.
[[nodiscard]] sdm::IslandReport ignore_islands(Input& input, const sdm::IslandLimits& limits);

/// The value of `ignored_islands` in reports.
[[nodiscard]] nlohmann::ordered_json to_json(const sdm::IslandReport& islands);

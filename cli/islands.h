// --ignore-islands: small components of a mesh, and small clusters of a cloud, are left out.
#pragma once

#include <sdm/mesh_edit.h>
#include <sdm/points.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "report.h"

/// Adds --ignore-islands.
void add_island_option(CLI::App& app, std::optional<sdm::IslandLimits>& limits);
/// Adds --ignore-islands-o2, which a distance never goes to.
void add_island_option_o2(CLI::App& app, std::optional<sdm::IslandLimits>& limits);
/// Adds --ignore-islands of a cloud.
void add_point_island_option(CLI::App& app, std::uint64_t& points);

/// Removes the islands of an input, which was not inspected, and notes how many.
[[nodiscard]] sdm::IslandReport ignore_islands(Input& input, const sdm::IslandLimits& limits);

/// A note on the islands of a cloud that were left out; nothing without islands.
[[nodiscard]] std::optional<std::string> note_on_islands(const std::string& cloud,
                                                         const sdm::PointDistances& found);

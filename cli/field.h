// What the commands that compute a distance field have in common.
#pragma once

#include <sdm/volume.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "common_options.h"

struct FieldCommand : RunOptions {
  std::string o2, transform_o2, units;
  std::vector<std::uint32_t> points;  // along x, y and z
  double spacing = 0;
  std::vector<double> bounds;  // low and high corner
  sdm::FieldOptions options;
  std::filesystem::path out;
};

/// Adds the options, whose parsing sets the command, which must outlive `app`. `box` describes what else the
/// grid extends around, in the help text.
void add_field_options(CLI::App& app, FieldCommand& command, const std::string& box);
/// Throws CLI::ValidationError for options that do not fit together, or a file of no known format.
void check_field_options(const FieldCommand& command);

/// The grid of the options. Without bounds, it extends around O2 by the maximum distance, or by a
/// tenth of O2's diagonal, and around `more`, which may be empty.
[[nodiscard]] sdm::Grid grid_of(const FieldCommand& command, const sdm::Mesh& o2, const sdm::Box& more);

/// The first lines of the text, up to the points beyond the maximum distance.
[[nodiscard]] std::string field_lines(const FieldCommand& command, const sdm::DistanceField& field);

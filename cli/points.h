// `sdm points`: from a point cloud and a mesh to the distances of the points.
#pragma once

#include <CLI/CLI.hpp>

/// Ends with CLI::RuntimeError(3) if a tolerance is exceeded.
void add_points_command(CLI::App& app);

// The output files of a map.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// Which files of a map are written.
struct MapFiles {
  bool exr = true;  ///< map.exr
  bool png = true;  ///< distance.png, voronoi.png and direction.png
  bool glb = true;  ///< model.glb
};

/// Their names, in the order in which they are listed for users.
[[nodiscard]] std::vector<std::string> names(const MapFiles& files);
/// The same, each followed by a space.
[[nodiscard]] std::string listed(const MapFiles& files);

/// --write, which sets `files`.
void add_write_option(CLI::App& app, MapFiles& files);

/// Writes the files concurrently. `at_vertices`: the distance at each vertex of the surface's mesh.
/// `boundary`: as for write_exr.
void write_map_files(const std::filesystem::path& folder, const MapFiles& files, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture, std::span<const std::uint8_t> boundary = {});

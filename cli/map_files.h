// The output files of a map.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <span>

/// Writes map.exr, model.glb, distance.png, direction.png and voronoi.png, concurrently. `at_vertices`: the
/// distance at each vertex of the surface's mesh. `boundary`: as for write_exr.
void write_map_files(const std::filesystem::path& folder, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture, std::span<const std::uint8_t> boundary = {});

// The output files of a map.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <span>
#include <vector>

/// The distance of each vertex to `sites`, negative inside as told by `sign`; NaN beyond the maximum
/// distance.
[[nodiscard]] std::vector<float> vertex_distances(const sdm::Mesh& mesh, const sdm::Sites& sites,
                                                  sdm::SignMethod sign, sdm::MapOptions options);

/// map.exr, model.glb, distance.png, direction.png and voronoi.png, at the same time.
void write_map_files(const std::filesystem::path& folder, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture);

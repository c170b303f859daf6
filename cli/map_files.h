// The files of a map.
#pragma once

#include <sdm/io.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// Writes map.exr, model.glb, distance.png, direction.png and voronoi.png into `folder`, and does `also` what
/// is left to do; all at the same time.
void write_map_files(const std::filesystem::path& folder, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture, const std::vector<std::function<void()>>& also);

void write_text(const std::filesystem::path& file, const std::string& text);

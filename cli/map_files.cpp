#include "map_files.h"

void write_map_files(const std::filesystem::path& folder, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture, std::span<const std::uint8_t> boundary) {
  sdm::run_concurrently({
      [&] { sdm::write_exr(folder / "map.exr", surface, map, boundary); },
      [&] { sdm::write_glb(folder / "model.glb", surface, map, at_vertices, picture); },
      [&] { sdm::write_distance_png(folder / "distance.png", surface, map, picture); },
      [&] { sdm::write_direction_png(folder / "direction.png", surface, map, picture); },
      [&] { sdm::write_voronoi_png(folder / "voronoi.png", surface, map, picture); },
  });
}

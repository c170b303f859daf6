#include "map_files.h"

#include "core/parallel.h"

#include <cmath>
#include <functional>

std::vector<float> vertex_distances(const sdm::Mesh& mesh, const sdm::Sites& sites, sdm::SignMethod sign,
                                    sdm::MapOptions options) {
  if (options.engine && sdm::engine_info(*options.engine).maps_only) options.engine = nullptr;
  const auto closest = sdm::closest_points(sites, mesh.positions, options);
  std::vector<std::uint8_t> is_inside(closest.size(), 0);
  if (sign != sdm::SignMethod::none) is_inside = sdm::inside_flags(sites, mesh.positions, closest, sign);
  std::vector<float> result;
  result.reserve(closest.size());
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const double d = closest[i].type == sdm::SiteType::none ? std::nan("") : closest[i].distance;
    result.push_back(static_cast<float>(is_inside[i] ? -d : d));
  }
  return result;
}

void write_map_files(const std::filesystem::path& folder, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices,
                     const sdm::PictureOptions& picture) {
  const std::vector<std::function<void()>> tasks{
      [&] { sdm::write_exr(folder / "map.exr", surface, map); },
      [&] { sdm::write_glb(folder / "model.glb", surface, map, at_vertices, picture); },
      [&] { sdm::write_distance_png(folder / "distance.png", surface, map, picture); },
      [&] { sdm::write_direction_png(folder / "direction.png", surface, map); },
      [&] { sdm::write_voronoi_png(folder / "voronoi.png", surface, map); },
  };
  sdm::parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) tasks[i]();
  });
}

#include <sdm/error.h>
#include <sdm/self_proximity_query.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "core/geometry/vec.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "map/map_writer.h"
#include "proximity/self/self_search.h"
#include "surface/tiles.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 256;  // tiles or faces

void check(const Sites& sites, const Exclusion& exclusion, const SelfMapOptions& options) {
  if (sites.mesh().triangles.size() != exclusion.faces())
    throw Error("the exclusion belongs to another mesh: its number of faces differs");
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
}

void gather_around(std::span<const Vec3> points, double max_distance, self::SelfSearch& search) {
  Box box;
  for (const Vec3& p : points) extend(box, p);
  double squared = 0;
  for (const Vec3& p : points) squared = std::max(squared, squared_norm(p - centre(box)));
  search.gather(centre(box), std::sqrt(squared), max_distance);
}

// Returns whether there is a closest point.
bool store(const ClosestPoint& closest, const Vec3& p, std::uint32_t texel, DistanceMap& map) {
  const bool found = closest.type != SiteType::none;
  map.distance[texel] = static_cast<float>(closest.distance);
  for (int k = 0; k < 3; ++k)
    map.vector[texel][k] = found ? static_cast<float>(closest.point[k] - p[k]) : 0.0f;
  map.site[texel] = closest.site;
  map.site_type[texel] = closest.type;
  return found;
}

}  // namespace

DistanceMap compute_self_map(const Surface& surface, const Sites& sites, const Exclusion& exclusion,
                             const SelfMapOptions& options) try {
  check(sites, exclusion, options);
  if (surface.mesh().triangles.size() != exclusion.faces())
    throw Error("surface and sites belong to different meshes: their numbers of faces differ");
  DistanceMap map;
  map::clear(map, surface);
  map.sign.reason = "the distance of a surface to itself has no sign";
  const surface::Tiles tiles(surface);
  std::atomic<std::size_t> none{0};
  parallel_for(tiles.count(), kGrain, options.progress, "map", [&](std::size_t begin, std::size_t end) {
    self::SelfSearch search(internals(sites), exclusion);
    std::vector<Vec3> points;
    std::size_t none_here = 0;
    for (auto tile = static_cast<std::uint32_t>(begin); tile < end; ++tile) {
      const std::span<const std::uint32_t> texels = tiles.of(tile);
      points.clear();
      for (const std::uint32_t texel : texels) points.push_back(surface.texel_point(texel));
      search.start_from(tiles.faces[tile]);
      gather_around(points, options.max_distance, search);
      for (std::size_t i = 0; i < texels.size(); ++i)
        none_here += !store(search.closest_to(points[i]), points[i], texels[i], map);
    }
    none += none_here;
  });
  map.beyond_max_distance = none;
  return map;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the map of a surface to itself");
}

std::vector<float> self_distances_at_vertices(const Sites& sites, const Exclusion& exclusion,
                                              const SelfMapOptions& options) try {
  check(sites, exclusion, options);
  const Mesh& mesh = sites.mesh();
  const mesh::Topology& topology = internals(sites).topology;
  std::vector<std::array<float, 3>> at_corners(mesh.triangles.size());
  parallel_for(mesh.triangles.size(), kGrain, options.progress, "vertices",
               [&](std::size_t begin, std::size_t end) {
                 self::SelfSearch search(internals(sites), exclusion);
                 for (std::size_t f = begin; f < end; ++f) {
                   if (topology.ignored(f)) continue;
                   search.start_from(static_cast<std::uint32_t>(f));
                   for (int k = 0; k < 3; ++k) {
                     const Vec3& p = mesh.positions[mesh.triangles[f][k]];
                     search.gather(p, 0, options.max_distance);
                     at_corners[f][k] = static_cast<float>(search.closest_to(p).distance);
                   }
                 }
               });
  std::vector<float> least(mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3 && !topology.ignored(f); ++k) {
      float& at_vertex = least[mesh.triangles[f][k]];
      at_vertex = std::fmin(at_vertex, at_corners[f][k]);  // ignores NaN
    }
  return least;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-distances at vertices");
}

}  // namespace sdm

#include <sdm/error.h>
#include <sdm/self_proximity_query.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>

#include "core/arrays/rows.h"
#include "core/atomic_extremes.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "map/map_writer.h"
#include "proximity/self/self_search.h"
#include "surface/tiles.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 256;  // tiles

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

// The tiles of each patch one after another.
Array<std::uint32_t> by_patch(const surface::Tiles& tiles, const self::PatchTree& patches,
                              const Exclusion& exclusion) {
  std::vector<std::uint32_t> place(exclusion.patches());
  for (std::uint32_t i = 0; i < place.size(); ++i) place[patches.order[i]] = i;
  return make_rows<std::uint32_t>(place.size(),
                                  [&](const auto& put) {
                                    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile)
                                      put(place[exclusion.patch_of(tiles.faces[tile])], tile);
                                  })
      .items;
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
  map.measured = {DistanceKind::self, "distance to the closest point of faces that are not excluded"};
  map.sign.reason = "the distance of a surface to itself has no sign";
  const surface::Tiles tiles(surface);
  const self::PatchTree patches(internals(sites), exclusion);
  const Array<std::uint32_t> order = by_patch(tiles, patches, exclusion);
  std::atomic<std::size_t> none{0};
  // Large enough that few patches are divided: each division excludes them again.
  const std::size_t grain = std::clamp<std::size_t>(order.size() / 256, kGrain, 16384);
  parallel_for(order.size(), grain, options.progress, "map", [&](std::size_t begin, std::size_t end) {
    self::SelfSearch search(internals(sites), exclusion, patches);
    std::vector<Vec3> points;
    std::size_t none_here = 0;
    for (std::size_t place = begin; place < end; ++place) {
      const std::uint32_t tile = order[place];
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
  const self::PatchTree patches(internals(sites), exclusion);
  // Faces that Sites ignores are skipped; +∞ for vertices of others.
  std::vector<float> least(mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
  const Array<std::uint32_t>& faces = internals(sites).tree.items;
  for (const std::uint32_t f : faces)
    for (const std::uint32_t v : mesh.triangles[f]) least[v] = std::numeric_limits<float>::infinity();
  // The faces of a patch exclude the same: one search from each vertex for all of them.
  parallel_for(patches.order.size(), self::grain_of_patches(exclusion), options.progress, "vertices",
               [&](std::size_t begin, std::size_t end) {
                 self::SelfSearch search(internals(sites), exclusion, patches);
                 std::vector<std::uint32_t> vertices;
                 for (std::size_t i = begin; i < end; ++i) {
                   vertices.clear();
                   for (const std::uint32_t f : exclusion.faces_of(patches.order[i])) {
                     if (internals(sites).topology.ignored(f)) continue;
                     search.start_from(f);
                     vertices.insert(vertices.end(), mesh.triangles[f].begin(), mesh.triangles[f].end());
                   }
                   std::ranges::sort(vertices);
                   vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
                   for (const std::uint32_t v : vertices) {
                     search.gather(mesh.positions[v], 0, options.max_distance);
                     atomic_min(least[v], static_cast<float>(search.closest_to(mesh.positions[v]).distance));
                   }
                 }
               });
  return least;
} catch (const std::bad_alloc&) {
  throw out_of_memory("self-distances at vertices");
}

}  // namespace sdm

#include <sdm/error.h>
#include <sdm/self.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "atlas/tiles.h"
#include "core/parallel.h"
#include "engine/map_writer.h"
#include "query/self_search.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 256;  // faces

void check(const Sites& sites, const Exclusion& exclusion, const SelfMapOptions& options) {
  if (sites.mesh().triangles.size() != exclusion.faces())
    throw Error("the exclusion is not one of this mesh: it has another number of faces");
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
}

}  // namespace

DistanceMap compute_self_map(const Surface& surface, const Sites& sites, const Exclusion& exclusion,
                             const SelfMapOptions& options) {
  check(sites, exclusion, options);
  if (surface.mesh().triangles.size() != exclusion.faces())
    throw Error("the surface is not that of the sites: it has another number of faces");
  DistanceMap map;
  clear(map, surface);
  map.sign.reason = "a surface has no inside of itself";
  const Tiles& tiles = tiles_of(surface);
  std::atomic<std::size_t> none{0};
  parallel_for(exclusion.faces(), kGrain, options.progress, "map", [&](std::size_t begin, std::size_t end) {
    SelfSearch search(sites.impl(), exclusion);
    std::size_t none_here = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = static_cast<std::uint32_t>(f);
      search.start_from(face);
      std::uint32_t guess = kNone;  // texels of a face, and only those, help each other: see parallel_for
      for (std::uint32_t i = tiles.face_offsets[f]; i < tiles.face_offsets[f + 1]; ++i) {
        const std::uint32_t texel = tiles.texels[i];
        const Vec3 p = surface.texel_point(texel);
        const ClosestPoint c = search.closest_to(p, options.max_distance, guess);
        const bool found = c.type != SiteType::none;
        map.distance[texel] = static_cast<float>(c.distance);
        for (int k = 0; k < 3; ++k)
          map.vector[texel][k] = found ? static_cast<float>(c.point[k] - p[k]) : 0.0f;
        map.site[texel] = c.site;
        map.site_type[texel] = c.type;
        none_here += !found;
        guess = c.face;
      }
    }
    none += none_here;
  });
  map.beyond_max_distance = none;
  return map;
}

std::vector<float> self_distances_at_vertices(const Sites& sites, const Exclusion& exclusion,
                                              const SelfMapOptions& options) {
  check(sites, exclusion, options);
  const Mesh& mesh = sites.mesh();
  std::vector<std::array<float, 3>> at_corners(mesh.triangles.size());
  parallel_for(mesh.triangles.size(), kGrain, options.progress, "vertices",
               [&](std::size_t begin, std::size_t end) {
                 SelfSearch search(sites.impl(), exclusion);
                 for (std::size_t f = begin; f < end; ++f) {
                   search.start_from(static_cast<std::uint32_t>(f));
                   std::uint32_t guess = kNone;
                   for (int k = 0; k < 3; ++k) {
                     const Vec3& p = mesh.positions[mesh.triangles[f][k]];
                     const ClosestPoint c = search.closest_to(p, options.max_distance, guess);
                     at_corners[f][k] = static_cast<float>(c.distance);
                     guess = c.face;
                   }
                 }
               });
  std::vector<float> least(mesh.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      float& at_vertex = least[mesh.triangles[f][k]];
      at_vertex = std::fmin(at_vertex, at_corners[f][k]);  // of NaN and a number the number
    }
  return least;
}

}  // namespace sdm

#include <sdm/error.h>
#include <sdm/match.h>

#include <new>

#include "core/memory.h"
#include "core/parallel.h"
#include "map/transfer/closest_of_texels.h"
#include "query/facing/outward_normals.h"

namespace sdm {
namespace {

MatchKind kind_without_point(const DistanceMap& map, std::size_t texel) {
  return map.unmatched.empty() || map.unmatched[texel] == 0 ? MatchKind::too_far : MatchKind::facing_away;
}

}  // namespace

TexelMatches closest_matches(const Surface& surface, const Sites& sites, const DistanceMap& map) try {
  const auto owners = surface.texel_faces();
  if (map.distance.size() != owners.size() || map.resolution != surface.resolution())
    throw Error("the map belongs to another surface: its number of texels differs");
  const bool facing = map.measured.kind == DistanceKind::facing;
  const std::vector<Vec3> normals = facing ? facing::outward_normals(surface.mesh()) : std::vector<Vec3>();
  TexelMatches matches{map.resolution, std::vector<MatchKind>(owners.size(), MatchKind::none),
                       std::vector<std::uint32_t>(owners.size(), kNone),
                       std::vector<std::array<float, 2>>(owners.size())};
  constexpr std::size_t kRowsOfRange = 8;
  parallel_for(map.rows(), kRowsOfRange, [&](std::size_t begin, std::size_t end) {
    map::ClosestOfTexels points(surface, sites, map, normals);
    for (std::size_t i = begin * map.resolution; i < end * map.resolution; ++i) {
      if (owners[i] == kNone) continue;
      const SurfacePoint point = points.at(static_cast<std::uint32_t>(i));
      if (point.face == kNone) {
        matches.kind[i] = kind_without_point(map, i);
        continue;
      }
      matches.kind[i] = facing ? MatchKind::facing : MatchKind::closest;
      matches.face[i] = point.face;
      matches.barycentric[i] = {static_cast<float>(point.barycentric[1]),
                                static_cast<float>(point.barycentric[2])};
    }
  });
  return matches;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the matches of texels");
}

}  // namespace sdm

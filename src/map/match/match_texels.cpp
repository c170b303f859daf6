#include <sdm/error.h>
#include <sdm/match.h>

#include <algorithm>
#include <new>
#include <optional>
#include <vector>

#include "closest/facing/facing_normals.h"
#include "closest/facing/facing_search.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "map/match/ray_matches.h"
#include "map/match/texel_match.h"
#include "map/transfer/closest_of_texels.h"

namespace sdm {
namespace {

MatchKind kind_of(const MeasuredDistance& measured) {
  switch (measured.kind) {
    case DistanceKind::closest:
    case DistanceKind::self:
      return MatchKind::closest;
    case DistanceKind::facing:
      return MatchKind::facing;
    case DistanceKind::along:
      return MatchKind::ray;
    case DistanceKind::thickness:
      break;
  }
  throw Error("a map of thickness has no matches: its vectors end on the surface itself");
}

}  // namespace

void require_matches(const Surface& surface, const Sites& sites, const TexelMatches& matches) {
  const std::size_t texels = surface.texel_faces().size(), faces = sites.mesh().triangles.size();
  if (matches.resolution != surface.resolution() || matches.kind.size() != texels ||
      matches.face.size() != texels || matches.barycentric.size() != texels)
    throw Error("the matches belong to another surface: their number of texels differs");
  if (std::ranges::any_of(matches.face, [&](std::uint32_t face) { return face != kNone && face >= faces; }))
    throw Error("the matches name a face that the other mesh does not have");
}

TexelMatches matches_of(const Surface& surface, const Sites& sites, const DistanceMap& map,
                        const Progress& progress) try {
  if (map.distance.size() != surface.map_faces().size() || map.resolution != surface.resolution())
    throw Error("the map belongs to another surface: its number of texels differs");
  const MatchKind found = kind_of(map.measured);
  const std::vector<Vec3> normals =
      found == MatchKind::facing ? facing::facing_normals(surface, map.measured.facing.value_or(90)).normals
                                 : std::vector<Vec3>();
  const auto faces = surface.texel_faces();
  TexelMatches matches = map::no_matches(surface);
  constexpr std::size_t kRowsOfTask = 8;
  parallel_for(map.rows(), kRowsOfTask, progress, "matches", [&](std::size_t begin, std::size_t end) {
    map::ClosestOfTexels points(surface, sites, map, normals);
    for (std::size_t i = begin * map.resolution; i < end * map.resolution; ++i) {
      if (faces[i] == kNone) continue;
      const SurfacePoint point = points.at(static_cast<std::uint32_t>(i));
      const bool away = !map.unmatched.empty() && map.unmatched[i] != 0;
      map::store_match(matches, i,
                       point.face != kNone ? found
                       : away              ? MatchKind::facing_away
                                           : MatchKind::too_far,
                       point);
    }
  });
  return matches;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the matches of texels");
}

TexelMatches match_texels(const Surface& surface, const Sites& sites, const MatchOptions& options) try {
  check_options(options);
  if (options.method == MatchMethod::ray) return map::ray_matches(surface, sites, options);
  MapOptions of_map{.engine = options.engine,
                    .sign = SignMethod::none,
                    .max_distance = options.max_distance,
                    .progress = options.progress};
  if (options.method == MatchMethod::facing) of_map.facing = options.facing;
  return matches_of(surface, sites, compute_map(surface, sites, of_map));
} catch (const std::bad_alloc&) {
  throw out_of_memory("the matches of texels");
}

}  // namespace sdm

#include <sdm/error.h>
#include <sdm/facing.h>

#include <cmath>
#include <new>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "query/facing/facing_search.h"
#include "sites/sites_data.h"

namespace sdm {

FacingPoints closest_facing_points(const Sites& sites, std::span<const Vec3> points,
                                   std::span<const Vec3> normals, const MapOptions& options) try {
  if (!options.facing) throw Error("closest_facing_points() needs an angle within which faces are allowed");
  if (normals.size() != points.size()) throw Error("closest_facing_points() needs one normal for each point");
  const facing::FacingSearch search(internals(sites), *options.facing);
  MapOptions unconstrained = options;
  unconstrained.facing.reset();
  FacingPoints result{closest_points(sites, points, unconstrained), {}, {}};
  result.behind.resize(points.size()), result.unmatched.resize(points.size());
  constexpr std::size_t kGrain = 256;
  parallel_for(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double length = norm(normals[i]);
      const Vec3 normal = length > 0 && std::isfinite(length) ? (1 / length) * normals[i] : Vec3{};
      const facing::Match match = search.match(points[i], normal, options.max_distance, result.closest[i]);
      result.closest[i] = match.closest;
      result.behind[i] = match.behind, result.unmatched[i] = match.unmatched;
    }
  });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("closest points of faces that face the queries");
}

}  // namespace sdm

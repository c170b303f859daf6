
#include "map/facing_map.h"
#include <sdm/error.h>
#include <sdm/facing.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <new>
#include "core/memory.h"
#include "core/numbers/number_text.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "map/map_writer.h"
#include "query/facing/facing_normals.h"
#include "query/facing/facing_search.h"

namespace sdm {
namespace map {
namespace {

/// Numbers of samples, indexed by their position, so that threads rarely write to the same cache line.
class SampleCounts {
 public:
  void add(std::size_t first, std::size_t beyond, std::size_t unmatched) {
    Counter& counter = counters_[first / 1024 % counters_.size()];
    counter.beyond += beyond, counter.unmatched += unmatched;
  }
  void store(DistanceMap& map) const {
    map.beyond_max_distance = map.without_match = 0;
    for (const Counter& counter : counters_)
      map.beyond_max_distance += counter.beyond, map.without_match += counter.unmatched;
  }

 private:
  struct alignas(64) Counter {
    std::atomic<std::size_t> beyond{0}, unmatched{0};
  };
  std::array<Counter, 64> counters_;
};

}  // namespace

void compute_facing_map(const Surface& surface, const Sites& sites, const MapOptions& options,
                        const Engine& engine, DistanceMap& map) {
  const facing::FacingSearch search(internals(sites), *options.facing);
  const std::vector<Vec3> normals = facing::facing_normals(surface.mesh(), *options.facing).normals;
  const std::span<const std::uint32_t> texels = surface.sample_texels(), faces = surface.texel_faces();
  map.sign = choose_sign(sites, options);
  map.measured = measured_distance(options);
  const bool is_signed = map.sign.method != SignMethod::none;
  clear(map, surface);
  const MapWriter writer(map, surface);
  map.unmatched.assign(map.distance.size(), 0);
  SampleCounts counts;
  engine.map(surface, sites, {options.max_distance, options.progress},
             [&](std::size_t first, std::span<const Vec3> points, const sites::ClosestPacket& closest) {
               sites::ClosestPacket matches = closest;
               std::uint32_t behind = 0;
               std::size_t unmatched = 0;
               for (std::size_t i = 0; i < closest.count; ++i) {
                 const ClosestPoint near = closest.get(i, points[i]);
                 const facing::Match match =
                     search.match(points[i], normals[faces[texels[first + i]]], options.max_distance, near);
                 behind |= static_cast<std::uint32_t>(is_signed && match.behind) << i;
                 map.unmatched[texels[first + i]] = match.unmatched ? 1 : 0;
                 unmatched += match.unmatched;
                 const ClosestPoint& found = match.closest;
                 if (found.type != near.type || found.site != near.site) matches.set(i, points[i], found);
               }
               const std::size_t without = writer.store(first, matches, behind);
               if (without > 0) counts.add(first, without - unmatched, unmatched);
             });
  counts.store(map);
  if (map.without_match == 0) map.unmatched.clear();
}

}  // namespace map

MeasuredDistance measured_distance(const MapOptions& options) {
  if (!options.facing) return {};
  facing::check_angle(*options.facing);
  return {DistanceKind::facing,
          "distance to the closest of the faces that face the same way, within " +
              number_text(*options.facing, 6) + "°",
          options.facing};
}

SignUsed choose_sign(const Sites& sites, const MapOptions& options) {
  if (!options.facing) return choose_sign(sites, options.sign);
  switch (options.sign) {
    case SignMethod::none:
      return {SignMethod::none, "asked for"};
    case SignMethod::automatic:
    case SignMethod::side:
      return {SignMethod::side, "by the side of the face that is matched"};
    default:
      throw Error(
          "distances to faces that face the samples have the sign of the side of these faces; use sign "
          "automatic, side or none",
          Remedy::sign_method);
  }
}

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

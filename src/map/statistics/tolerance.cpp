#include <sdm/error.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vec.h"
#include "map/statistics/tolerance_limits.h"

namespace sdm {

ToleranceVerdict check_tolerance(const Surface& surface, const DistanceMap& map,
                                 std::span<const float> vertex_distances, double error_bound, double accuracy,
                                 const Tolerance& tolerance) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("check_tolerance() needs one distance for each vertex of the surface's mesh");
  if (tolerance.needs_sign() && map.sign.method == SignMethod::none)
    throw Error("a tolerance that differs by sign needs signed distances, but these are unsigned: " +
                    map.sign.reason + "; choose another sign method or a symmetric tolerance",
                Remedy::sign_method);

  ToleranceVerdict verdict{.tolerance = tolerance};
  verdict.shares = tolerance_shares(surface, map, tolerance, accuracy);
  verdict.exceeded_area_fraction = verdict.shares.below + verdict.shares.above + verdict.shares.without_value;

  bool valued = map.beyond_max_distance == 0;
  double lowest = kInfinity, highest = -kInfinity;
  for (const std::uint32_t texel : surface.sample_texels()) {
    lowest = std::fmin(lowest, map.distance[texel]);
    highest = std::fmax(highest, map.distance[texel]);
  }
  for (const Triangle& triangle : surface.mesh().triangles) {
    if (is_removed(triangle)) continue;
    for (const std::uint32_t vertex : triangle) {
      const double d = vertex_distances[vertex];
      valued = valued && !std::isnan(d);
      lowest = std::fmin(lowest, d), highest = std::fmax(highest, d);
    }
  }
  const double farthest = std::max(-lowest, highest);
  verdict.largest = valued ? std::max(0.0, farthest) : kInfinity;
  const map::ToleranceLimits limits(tolerance, accuracy);
  verdict.within = valued && !limits.below(lowest) && !limits.above(highest);

  // Estimated signs jump: between samples a distance may have the other one.
  const bool estimated = map.sign.method == SignMethod::winding;
  if (!verdict.within) {
    verdict.certified = !estimated || !valued || farthest - accuracy > std::max(-tolerance.lo, tolerance.hi);
    verdict.verdict = Verdict::fail;
    return verdict;
  }
  if (estimated) lowest = -farthest, highest = farthest;
  const double margin = std::min(tolerance.hi - highest, lowest - tolerance.lo) - accuracy;
  verdict.certified = error_bound <= margin;
  verdict.verdict = verdict.certified ? Verdict::pass : Verdict::not_decided;
  if (!verdict.certified) verdict.deciding_bound = std::max(0.0, margin / 2);
  return verdict;
}

double engine_accuracy(const EngineInfo& engine, const Mesh& on, const Mesh& to) {
  Box box = bounds(on);
  extend(box, bounds(to));
  return engine.relative_error * diagonal(box);
}

}  // namespace sdm

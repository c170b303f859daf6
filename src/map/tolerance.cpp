#include <sdm/error.h>
#include <sdm/statistics.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/vec.h"

namespace sdm {

ToleranceVerdict check_tolerance(const Surface& surface, const DistanceMap& map,
                                 std::span<const float> vertex_distances, double error_bound, double accuracy,
                                 double tolerance) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("check_tolerance() needs one distance for each vertex of the surface's mesh");
  ToleranceVerdict verdict{.tolerance = tolerance};
  verdict.exceeded_area_fraction = area_fraction_beyond(surface, map, tolerance + accuracy);
  verdict.largest = map.beyond_max_distance > 0 ? kInfinity : 0;
  for (const std::uint32_t texel : surface.sample_texels())
    verdict.largest = std::fmax(verdict.largest, std::abs(map.distance[texel]));
  for (const Triangle& triangle : surface.mesh().triangles)
    for (const std::uint32_t vertex : triangle) {
      const double d = std::abs(vertex_distances[vertex]);
      verdict.largest = std::isnan(d) ? kInfinity : std::max(verdict.largest, d);
    }
  verdict.within = verdict.largest <= tolerance + accuracy;
  verdict.certified = !verdict.within || verdict.largest + error_bound + accuracy <= tolerance;
  return verdict;
}

double engine_accuracy(const EngineInfo& engine, const Mesh& on, const Mesh& to) {
  Box box = bounds(on);
  extend(box, bounds(to));
  return engine.relative_error * diagonal(box);
}

}  // namespace sdm

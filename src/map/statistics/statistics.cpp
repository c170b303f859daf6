#include <sdm/error.h>
#include <sdm/statistics.h>

#include <cmath>
#include <limits>

#include "map/statistics/weighted_statistics.h"
#include "map/statistics/weighted_texels.h"

namespace sdm {

DistanceStatistics statistics(const Surface& surface, const DistanceMap& map) {
  const map::WeightedTexels texels(surface, map);
  return map::weighted_statistics(map::WeightedTexels::kParts, [&](std::size_t part, const auto& visit) {
    texels.for_each(part, [&](float d, float weight, std::uint32_t) {
      if (std::isfinite(d)) visit(d, weight);
    });
  });
}

std::optional<Extremes> extremes(const Surface& surface, const DistanceMap& map,
                                 std::span<const float> vertex_distances) {
  if (map.distance.size() != surface.map_faces().size())
    throw Error("the map belongs to another surface: its number of texels differs");
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("extremes() needs one distance for each vertex of the surface's mesh");
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Extremes result{.min = {.distance = kNan}, .max = {.distance = kNan}};
  // Returns whether it is a new extreme; comparisons with NaN are false.
  const auto less = [&](double d) { return !(result.min.distance <= d) && !std::isnan(d); };
  const auto greater = [&](double d) { return !(result.max.distance >= d) && !std::isnan(d); };
  std::size_t least = 0, most = 0;
  const auto owners = surface.map_faces();
  for (std::size_t texel = 0; texel < owners.size(); ++texel) {
    const double d = map.distance[texel];
    if (owners[texel] == kNone || std::isinf(d)) continue;
    if (less(d)) {
      result.min.distance = d;
      least = texel;
    }
    if (greater(d)) {
      result.max.distance = d;
      most = texel;
    }
  }
  const auto place = [&](Extreme& extreme, std::size_t texel) {
    if (!std::isnan(extreme.distance)) extreme.point = surface.texel_point(static_cast<std::uint32_t>(texel));
  };
  place(result.min, least);
  place(result.max, most);
  for (const Triangle& triangle : surface.mesh().triangles) {
    if (is_removed(triangle)) continue;
    for (const std::uint32_t v : triangle) {
      const double d = vertex_distances[v];
      if (std::isinf(d)) continue;
      if (less(d)) result.min = {d, surface.mesh().positions[v], true};
      if (greater(d)) result.max = {d, surface.mesh().positions[v], true};
    }
  }
  if (std::isnan(result.min.distance)) return std::nullopt;
  return result;
}

}  // namespace sdm

#include "summary/verdict/missing_signs.h"

#include <sdm/vertex_distances.h>

#include <algorithm>
#include <cmath>

#include "map/statistics/tolerance_limits.h"

namespace sdm::summary {

void withhold_failure_by_missing_signs(ToleranceVerdict& verdict, const Surface& surface, const Sites& sites,
                                       const DistanceMap& map, std::span<const float> vertex_distances,
                                       std::span<const std::uint8_t> in_set, double accuracy) {
  if (verdict.reason != VerdictReason::exceeded || verdict.certified ||
      map.measured.kind != DistanceKind::closest || map.sign.method != SignMethod::side)
    return;
  const map::ToleranceLimits limits(verdict.tolerance, accuracy);
  const auto is_out = [&](float d) { return limits.below(d) || limits.above(d); };
  const auto decides = [&](float d, bool has_sign) {
    return std::isfinite(d) && is_out(d) && (has_sign || is_out(-d));
  };
  const auto has_face = [&](std::uint32_t face) { return in_set.empty() || in_set[face] != 0; };
  const std::vector<std::uint8_t> texels = boundary_mask(sites, map);
  if (std::ranges::any_of(surface.sample_texels(), [&](std::uint32_t texel) {
        return has_face(surface.texel_faces()[texel]) && decides(map.distance[texel], texels[texel] == 0);
      }))
    return;
  const std::vector<std::uint8_t> vertices = boundary_vertices(surface.mesh(), sites);
  for (std::uint32_t face = 0; face < surface.mesh().triangles.size(); ++face) {
    const Triangle& triangle = surface.mesh().triangles[face];
    if (is_removed(triangle) || !has_face(face)) continue;
    for (const std::uint32_t vertex : triangle)
      if (decides(vertex_distances[vertex], vertices[vertex] == 0)) return;
  }
  verdict.verdict = Verdict::not_decided, verdict.reason = VerdictReason::estimated_signs;
  verdict.within = true;
}

}  // namespace sdm::summary

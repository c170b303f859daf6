#include "summary/verdict/missing_signs.h"

#include <sdm/map.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "summary/verdict/sample_evidence.h"

namespace sdm::summary {

void withhold_failures_by_missing_signs(std::span<ToleranceVerdict> verdicts, const FaceGroups& groups,
                                        const Surface& surface, const Sites& sites, const DistanceMap& map,
                                        std::span<const float> vertex_distances, double accuracy) {
  const auto in_question = [&](const ToleranceVerdict& verdict) {
    return may_lack_signs(verdict, map.measured.kind, map.sign.method);
  };
  if (std::ranges::none_of(verdicts, in_question)) return;
  std::vector<SignedSamples> samples(groups.count);
  const std::vector<std::uint8_t> texels = boundary_mask(sites, map);
  for (const std::uint32_t texel : surface.sample_texels())
    if (const std::uint32_t group = groups.group(surface.map_faces()[texel]);
        group != kNone && std::isfinite(map.distance[texel]))
      samples[group].add(map.distance[texel], texels[texel] == 0);
  const std::vector<std::uint8_t> vertices = boundary_vertices(surface.mesh(), sites);
  const auto& triangles = surface.mesh().triangles;
  for (std::uint32_t face = 0; face < triangles.size(); ++face) {
    const std::uint32_t group = groups.group(face);
    if (is_removed(triangles[face]) || group == kNone) continue;
    for (const std::uint32_t vertex : triangles[face])
      if (std::isfinite(vertex_distances[vertex]))
        samples[group].add(vertex_distances[vertex], vertices[vertex] == 0);
  }
  for (std::size_t g = 0; g < verdicts.size(); ++g)
    if (in_question(verdicts[g]) && !samples[g].any_out(verdicts[g].tolerance, accuracy))
      withhold_failure(verdicts[g]);
}

}  // namespace sdm::summary

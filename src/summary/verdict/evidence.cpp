#include "summary/verdict/evidence.h"

#include <sdm/error.h>
#include <sdm/map.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "map/statistics/tolerance_limits.h"
#include "map/statistics/weighted_texels.h"

namespace sdm {
namespace summary {
namespace {

/// The samples of a group that have no value, and whether one of them has none for want of a match, which is
/// the reason then, rather than since its match is beyond the maximum distance.
struct WithoutValue {
  bool unmatched = false, beyond = false, vertex = false;

  void add_texel(const DistanceMap& map, std::uint32_t texel) {
    (map.unmatched.empty() || map.unmatched[texel] == 0 ? beyond : unmatched) = true;
  }
  [[nodiscard]] bool any() const { return unmatched || beyond || vertex; }
  /// Vertices do not say what they lack: they count as the texels of the group or, if these have values, of
  /// the map.
  [[nodiscard]] bool is_unmatched(const DistanceMap& map) const {
    if (unmatched || beyond || !vertex || !may_lack_match(map.measured.kind)) return unmatched;
    return map.without_match > 0 || map.beyond_max_distance == 0;
  }
};

}  // namespace

std::vector<Evidence> evidence_of_groups(const Surface& surface, const DistanceMap& map,
                                         std::span<const float> vertex_distances, const FaceGroups& groups,
                                         double accuracy) {
  if (map.distance.size() != surface.map_faces().size()) throw Error("the map belongs to another surface");
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("a verdict needs one distance for each vertex of the surface's mesh");
  std::vector<DistanceRange> ranges(groups.count);
  std::vector<WithoutValue> without(groups.count);
  const std::span<const std::uint32_t> faces = surface.map_faces();
  for (const std::uint32_t texel : surface.sample_texels()) {
    const std::uint32_t group = groups.group(faces[texel]);
    if (group == kNone) continue;
    const float d = map.distance[texel];
    if (!std::isfinite(d))
      without[group].add_texel(map, texel);
    else if (DistanceRange& range = ranges[group]; !range.lowest || d <= *range.lowest || d >= *range.highest)
      range.add(d);  // few samples are extremes
  }
  const auto& triangles = surface.mesh().triangles;
  for (std::uint32_t face = 0; face < triangles.size(); ++face) {
    const std::uint32_t group = groups.group(face);
    if (is_removed(triangles[face]) || group == kNone) continue;
    for (const std::uint32_t vertex : triangles[face])
      if (const double d = vertex_distances[vertex]; std::isfinite(d))
        ranges[group].add(d);
      else
        without[group].vertex = true;
  }
  std::vector<Evidence> result;
  for (std::size_t g = 0; g < groups.count; ++g)
    result.push_back({.lowest = ranges[g].lowest,
                      .highest = ranges[g].highest,
                      .complete = !without[g].any(),
                      .unmatched = without[g].is_unmatched(map),
                      .estimated_signs = has_estimated_signs(map.measured.kind, map.sign.method),
                      .samples_only = !is_lipschitz(map.measured.kind),
                      .accuracy = accuracy,
                      .error_bound = kInfinity,
                      .is_signed = map.sign.method != SignMethod::none});
  return result;
}

std::vector<GroupArea> areas_of_groups(const Surface& surface, const DistanceMap& map,
                                       const FaceGroups& groups, std::span<const Tolerance> tolerances,
                                       double accuracy) {
  const map::WeightedTexels texels(surface, map);
  std::vector<map::ToleranceLimits> limits;
  for (const Tolerance& tolerance : tolerances) limits.emplace_back(tolerance, accuracy);
  std::vector<GroupArea> result(groups.count);
  for (std::size_t part = 0; part < map::WeightedTexels::kParts; ++part)
    texels.for_each(part, [&](float d, float weight, std::uint32_t face) {
      const std::uint32_t group = groups.group(face);
      if (group == kNone) return;
      auto& [shares, area] = result[group];
      area += weight;
      (!std::isfinite(d)        ? shares.without_value
       : limits[group].below(d) ? shares.below
       : limits[group].above(d) ? shares.above
                                : shares.within) += weight;
    });
  for (auto& [shares, area] : result) {
    if (area > 0)
      for (double* share : {&shares.below, &shares.within, &shares.above, &shares.without_value})
        *share /= area;
    area *= texels.largest_area();
  }
  return result;
}

}  // namespace summary

Evidence evidence_of(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                     double error_bound, double accuracy) {
  Evidence evidence = summary::evidence_of_groups(surface, map, vertex_distances, {}, accuracy).front();
  if (is_lipschitz(map.measured.kind)) evidence.error_bound = error_bound;
  return evidence;
}

}  // namespace sdm

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

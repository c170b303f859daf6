#include <sdm/error.h>
#include <sdm/group_verdicts.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "summary/verdict/certify.h"
#include "summary/verdict/missing_signs.h"

namespace sdm {
namespace {

/// The faces that have a name.
struct NamedFaces {
  std::string kind;
  std::vector<std::uint32_t> faces;
};

NamedFaces faces_named(std::span<const FaceNames> names, const std::string& group) {
  for (const FaceNames& kind : names) {
    const auto found = std::ranges::find(kind.names, group);
    if (found == kind.names.end()) continue;
    NamedFaces result{.kind = kind.kind, .faces = {}};
    const auto name = static_cast<std::uint32_t>(found - kind.names.begin());
    for (std::uint32_t f = 0; f < kind.of_face.size(); ++f)
      if (kind.of_face[f] == name) result.faces.push_back(f);
    return result;
  }
  return {};
}

// Points of the group may be nearest to a sample of another group, so that the error bound of the map says
// nothing here: what the samples do not refute is left to the proof.
Evidence evidence_of_faces(const Surface& surface, const DistanceMap& map,
                           std::span<const float> vertex_distances, const std::vector<std::uint8_t>& in_group,
                           std::span<const std::uint32_t> faces, double accuracy) {
  const bool is_closest = map.measured.kind == DistanceKind::closest;
  Evidence evidence{.estimated_signs = is_closest && is_estimate(map.sign.method),
                    .samples_only = !is_closest,
                    .accuracy = accuracy,
                    .error_bound = std::numeric_limits<double>::infinity(),
                    .is_signed = map.sign.method != SignMethod::none};
  const auto add = [&](double d) {
    evidence.lowest = std::fmin(evidence.lowest.value_or(d), d);
    evidence.highest = std::fmax(evidence.highest.value_or(d), d);
  };
  summary::WithoutValue without(map);
  for (const std::uint32_t texel : surface.sample_texels())
    if (in_group[surface.texel_faces()[texel]] != 0) {
      if (std::isfinite(map.distance[texel]))
        add(map.distance[texel]);
      else
        without.add_texel(texel);
    }
  for (const std::uint32_t face : faces)
    for (const std::uint32_t vertex : surface.mesh().triangles[face])
      if (std::isfinite(vertex_distances[vertex]))
        add(vertex_distances[vertex]);
      else
        without.add_vertex();
  evidence.complete = !without.any(), evidence.unmatched = without.unmatched();
  return evidence;
}

Verdict worst_of(const std::vector<GroupVerdict>& groups, bool doubted) {
  const auto any = [&](Verdict verdict) {
    return std::ranges::any_of(groups, [&](const GroupVerdict& g) { return g.verdict.verdict == verdict; });
  };
  for (const Verdict verdict : {Verdict::fail, Verdict::not_decided})
    if (any(verdict)) return verdict;
  return doubted ? Verdict::doubtful : Verdict::pass;
}

}  // namespace

GroupVerdicts certify_groups(const Surface& surface, const Sites& sites, const DistanceMap& map,
                             std::span<const float> vertex_distances, std::span<const FaceNames> names,
                             std::span<const GroupTolerance> table, const CertifyGroupsOptions& options) {
  if (map.distance.size() != surface.texel_faces().size()) throw Error("the map belongs to another surface");
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("a verdict needs one distance for each vertex of the surface's mesh");
  GroupVerdicts result;
  for (const auto& [group, tolerance] : table) {
    const NamedFaces named = faces_named(names, group);
    if (named.faces.empty()) continue;
    if (tolerance.needs_sign() && map.sign.method == SignMethod::none)
      throw Error("the tolerance of group " + group +
                  " differs by sign, but the distances are unsigned: " + map.sign.reason);
    std::vector<std::uint8_t> in_group(surface.mesh().triangles.size());
    std::vector<std::uint32_t> part(in_group.size(), kNone);
    for (const std::uint32_t face : named.faces) in_group[face] = 1, part[face] = 0;
    const Evidence evidence =
        evidence_of_faces(surface, map, vertex_distances, in_group, named.faces, options.accuracy);
    ToleranceVerdict sampled{judge(evidence, tolerance), tolerance, {}, 0, {}};
    const double accuracy = std::isfinite(options.accuracy) ? options.accuracy : 0;
    const auto parts = part_statistics(surface, map, part, 1, {.tolerance = tolerance, .accuracy = accuracy});
    if (parts.front().tolerance) sampled.shares = *parts.front().tolerance;
    sampled.exceeded_area_fraction =
        sampled.shares.below + sampled.shares.above + sampled.shares.without_value;
    if (evidence.complete && evidence.lowest)
      sampled.largest = std::max({0.0, -*evidence.lowest, *evidence.highest});
    summary::withhold_failure_by_missing_signs(sampled, surface, sites, map, vertex_distances, in_group,
                                               options.accuracy);
    result.groups.push_back({.kind = named.kind,
                             .group = group,
                             .faces = named.faces.size(),
                             .lowest = evidence.lowest,
                             .highest = evidence.highest,
                             .verdict = summary::certify(sampled, surface.mesh(), sites, map.measured.kind,
                                                         {.sign = map.sign.method,
                                                          .accuracy = options.accuracy,
                                                          .faces = std::span(named.faces),
                                                          .progress = options.progress})});
  }
  result.verdict = worst_of(result.groups, options.doubted);
  return result;
}

}  // namespace sdm

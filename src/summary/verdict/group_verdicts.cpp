#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cmath>

#include "summary/verdict/certify.h"
#include "summary/verdict/evidence.h"
#include "summary/verdict/group_rows.h"

namespace sdm {
namespace {

using summary::GroupRows;

/// What the samples of a group show.
struct SampledGroup {
  Evidence evidence;
  ToleranceVerdict verdict;
  double area = 0;
};

/// Judges the groups of a layer by their samples, in one pass over the map. Points of a group may be nearest
/// to a sample of another group, so that the error bound of the map says nothing here: what the samples do
/// not refute is left to the proof.
std::vector<SampledGroup> judge_samples(const Surface& surface, const Sites& sites, const DistanceMap& map,
                                        std::span<const float> vertex_distances,
                                        const GroupRows::Layer& layer, std::span<const Tolerance> tolerances,
                                        const CertifyGroupsOptions& options) {
  const summary::FaceGroups groups{layer.of_face, layer.count};
  std::vector<Evidence> evidence =
      summary::evidence_of_groups(surface, map, vertex_distances, groups, options.accuracy);
  const double guard = options.guard + options.uncertainty, accuracy = options.accuracy + guard;
  for (Evidence& e : evidence) {
    e.guard = guard;
    e.uncertainty = options.uncertainty;
  }
  const std::vector<summary::GroupArea> areas =
      summary::areas_of_groups(surface, map, groups, tolerances, std::isfinite(accuracy) ? accuracy : 0);
  std::vector<ToleranceVerdict> verdicts;
  for (std::size_t g = 0; g < layer.count; ++g) {
    ToleranceVerdict& v = verdicts.emplace_back(
        ToleranceVerdict{judge(evidence[g], tolerances[g]), tolerances[g], {}, 0, areas[g].shares});
    v.exceeded_area_fraction = v.shares.below + v.shares.above + v.shares.without_value;
    if (evidence[g].complete && evidence[g].lowest)
      v.largest = std::max({0.0, -*evidence[g].lowest, *evidence[g].highest});
  }
  summary::withhold_failures_by_missing_signs(verdicts, groups, surface, sites, map, vertex_distances,
                                              accuracy);
  std::vector<SampledGroup> result;
  for (std::size_t g = 0; g < layer.count; ++g) result.push_back({evidence[g], verdicts[g], areas[g].area});
  return result;
}

}  // namespace

GroupVerdicts certify_groups(const Surface& surface, const Sites& sites, const DistanceMap& map,
                             std::span<const float> vertex_distances, std::span<const FaceNames> names,
                             std::span<const GroupTolerance> table, const CertifyGroupsOptions& options) {
  const GroupRows groups(names, table, surface.mesh().triangles.size());
  for (const GroupRows::Row& row : groups.rows) summary::check_sign(row.group, map.sign);
  std::vector<std::vector<SampledGroup>> sampled;
  for (std::size_t l = 0; l < groups.layers.size(); ++l) {
    std::vector<Tolerance> tolerances;
    for (const GroupRows::Row& row : groups.rows)
      if (row.layer == l) tolerances.push_back(row.group.tolerance);
    sampled.push_back(
        judge_samples(surface, sites, map, vertex_distances, groups.layers[l], tolerances, options));
  }
  GroupVerdicts result;
  summary::Certifier certify(surface.mesh(), sites, map,
                             {.accuracy = options.accuracy,
                              .guard = options.guard,
                              .uncertainty = options.uncertainty,
                              .accept_doubts = options.accept_doubts,
                              .progress = options.progress});
  for (const GroupRows::Row& row : groups.rows) {
    const auto& [evidence, verdict, area] = sampled[row.layer][row.number];
    result.groups.push_back({.kind = row.named.kind,
                             .group = row.group.group,
                             .faces = row.named.faces.size(),
                             .area = area,
                             .lowest = evidence.lowest,
                             .highest = evidence.highest,
                             .verdict = certify(verdict, std::span(row.named.faces))});
  }
  result.verdict = summary::worst_of(result.groups, options.doubted);
  return result;
}

GroupVerdicts judge_groups(std::span<const GroupPoints> groups, const PointsWithoutGroup& without_group,
                           SignMethod sign, DistanceKind measured, bool accept_doubts) {
  GroupVerdicts result;
  result.without_group = without_group;
  for (const GroupPoints& g : groups) {
    Judgement judgement = judge(g.evidence, g.row.tolerance);
    if (summary::may_lack_signs(judgement, measured, sign) && !g.out_with_either_sign)
      summary::withhold_failure(judgement);
    CertifiedVerdict verdict{{judgement, g.row.tolerance, {}, 0, {}}, {}};
    summary::decide_thin_walls(verdict, g.by_facing, accept_doubts);
    if (g.points > 0) {
      const auto all = static_cast<double>(g.points);
      verdict.shares.below = static_cast<double>(g.below) / all;
      verdict.shares.above = static_cast<double>(g.above) / all;
      verdict.shares.within = static_cast<double>(g.points - g.below - g.above) / all;
      verdict.exceeded_area_fraction = static_cast<double>(g.below + g.above) / all;
      verdict.largest = std::max({0.0, -*g.evidence.lowest, *g.evidence.highest});
    }
    result.groups.push_back({.kind = g.kind,
                             .group = g.row.group,
                             .faces = g.faces,
                             .points = g.points,
                             .lowest = g.evidence.lowest,
                             .highest = g.evidence.highest,
                             .verdict = verdict});
  }
  result.verdict = without_group.any() ? Verdict::fail : summary::worst_of(result.groups, false);
  return result;
}

void withhold_pass(GroupVerdicts& verdicts) {
  if (verdicts.verdict == Verdict::pass) verdicts.verdict = Verdict::doubtful;
}

}  // namespace sdm

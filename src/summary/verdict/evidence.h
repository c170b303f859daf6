// The evidence of the samples of a map, of all of them or by group.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "map/statistics/tolerance_limits.h"

namespace sdm::summary {

/// The least and the largest of some distances.
struct DistanceRange {
  std::optional<double> lowest{}, highest{};

  void add(double d) {
    lowest = std::fmin(lowest.value_or(d), d);
    highest = std::fmax(highest.value_or(d), d);
  }
};

/// The distances of samples by whether they have a sign. At the boundary of an open O2 there is none: by
/// SignMethod::side, the distance is |d| there.
class SignedSamples {
 public:
  void add(double d, bool has_sign) { (has_sign ? signed_ : unsigned_).add(d); }

  /// Whether a sample is out of the tolerance, whatever its sign if it has none. A range suffices: what is
  /// out of an interval on one side of it is out at the end of the range.
  [[nodiscard]] bool any_out(const Tolerance& tolerance, double accuracy) const {
    const map::ToleranceLimits limits(tolerance, accuracy);
    const auto is_out = [&](double d) { return limits.below(d) || limits.above(d); };
    if (signed_.lowest && (is_out(*signed_.lowest) || is_out(*signed_.highest))) return true;
    const auto with_either = [&](double d) { return is_out(d) && is_out(-d); };
    return unsigned_.lowest && (with_either(*unsigned_.lowest) || with_either(*unsigned_.highest));
  }

  /// Whether a sample without a sign is not within the tolerance with either one.
  [[nodiscard]] bool missing_signs_matter(const Tolerance& tolerance, double accuracy) const {
    return unsigned_.highest &&
           !(*unsigned_.highest + accuracy <= std::min(-tolerance.lower, tolerance.upper));
  }

 private:
  DistanceRange signed_, unsigned_;
};

/// Whether a failure may be due to the signs of samples which have none.
[[nodiscard]] inline bool may_lack_signs(const Judgement& judgement, DistanceKind measured, SignMethod sign) {
  return judgement.reason == VerdictReason::exceeded && !judgement.certified &&
         lacks_boundary_signs(measured, sign);
}

/// judge() of a cloud by SignMethod::side, whose points have the sign that they have, unless those without
/// one matter: between points there is nothing.
[[nodiscard]] inline Judgement judge_by_side(const Evidence& evidence, const Tolerance& tolerance,
                                             bool missing_signs_matter) {
  const Judgement judgement = judge(evidence, tolerance);
  if (judgement.reason != VerdictReason::estimated_signs || missing_signs_matter) return judgement;
  Evidence with_signs = evidence;
  with_signs.estimated_signs = false;
  return judge(with_signs, tolerance);
}

/// Whether that is a pass.
[[nodiscard]] inline bool passes_by_side(const Evidence& evidence, const Tolerance& tolerance,
                                         bool missing_signs_matter) {
  return judge_by_side(evidence, tolerance, missing_signs_matter).verdict == Verdict::pass;
}

/// A failure by samples without a sign is none.
inline void withhold_failure(Judgement& judgement) {
  judgement.verdict = Verdict::not_decided;
  judgement.reason = VerdictReason::estimated_signs;
  judgement.within = true;
}

/// A partition of the faces of a surface: `of_face[f]` is the number of the group of face f, below `count`,
/// or kNone. Empty: all faces are group 0.
struct FaceGroups {
  std::span<const std::uint32_t> of_face{};
  std::size_t count = 1;

  [[nodiscard]] std::uint32_t group(std::uint32_t face) const { return of_face.empty() ? 0 : of_face[face]; }
};

/// Returns the evidence of each group, from the texels and the vertices of its faces, with an infinite error
/// bound. Throws sdm::Error if the map or the distances belong to another surface. Cost: linear in texels and
/// faces, for all groups together.
[[nodiscard]] std::vector<Evidence> evidence_of_groups(const Surface& surface, const DistanceMap& map,
                                                       std::span<const float> vertex_distances,
                                                       const FaceGroups& groups, double accuracy);

/// check_tolerance() of some evidence of a map.
[[nodiscard]] ToleranceVerdict check_evidence(const Surface& surface, const DistanceMap& map,
                                              const Evidence& evidence, const Tolerance& tolerance);

/// The area of the texels of a group, and its shares.
struct GroupArea {
  ToleranceShares shares;
  double area = 0;  ///< in squared units of the surface
};

/// Returns the area of each group, and how much of it is out of its tolerance. Cost: linear in texels, for
/// all groups together.
[[nodiscard]] std::vector<GroupArea> areas_of_groups(const Surface& surface, const DistanceMap& map,
                                                     const FaceGroups& groups,
                                                     std::span<const Tolerance> tolerances, double accuracy);

/// Samples at the boundary of an open O2 have no side: their distances by SignMethod::side are |d|. Where
/// only such samples of a group are out of its tolerance, and each by one of the two signs only, a failure
/// becomes Verdict::not_decided. `verdicts`: one for each group. Cost: none unless a failure depends on
/// signs; then linear for all groups together, and a search for each vertex.
void withhold_failures_by_missing_signs(std::span<ToleranceVerdict> verdicts, const FaceGroups& groups,
                                        const Surface& surface, const Sites& sites, const DistanceMap& map,
                                        std::span<const float> vertex_distances, double accuracy);

}  // namespace sdm::summary

// What the samples of a surface, of its groups or of a cloud show of a tolerance.
#pragma once

#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

}  // namespace sdm::summary

#include <sdm/error.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vec.h"
#include "map/statistics/tolerance_limits.h"
#include "summary/verdict/evidence.h"

namespace sdm {

namespace {

/// The limits, less a lower one that unsigned distances cannot exceed.
Tolerance limits_of(const Tolerance& tolerance, bool is_signed) {
  return is_signed || tolerance.lo > 0 ? tolerance
                                       : Tolerance(-std::numeric_limits<double>::infinity(), tolerance.hi);
}

/// How far the distances stay from the limits.
double margin_of(double lowest, double highest, const Tolerance& tolerance, double accuracy) {
  return std::min(tolerance.hi - highest, lowest - tolerance.lo) - accuracy;
}

/// Whether walls hide what is out of the limits: no point of a wall is farther than its half from both skins.
bool are_walls_thin(const Evidence& evidence, const Tolerance& limits) {
  return 2 * largest_limit(limits) > evidence.thin_walls;
}

/// What is not decided of evidence that is within the tolerance: `measured` is its margin with the signs as
/// they were found.
VerdictReason open_question(const Evidence& evidence, double margin, double measured) {
  if (!evidence.lowest) return VerdictReason::nothing_measured;
  if (!std::isfinite(evidence.accuracy)) return VerdictReason::unknown_accuracy;
  if (evidence.error_bound <= measured || (margin <= 0 && measured > 0))
    return VerdictReason::estimated_signs;
  if (margin > 0) return VerdictReason::between_samples;
  return evidence.guard > 0 ? VerdictReason::guard_band : VerdictReason::within_rounding;
}

}  // namespace

Judgement judge(const Evidence& evidence, const Tolerance& tolerance) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double lowest = evidence.lowest.value_or(kInfinity), highest = evidence.highest.value_or(-kInfinity);
  const bool complete = evidence.complete, estimated_signs = evidence.estimated_signs;
  const double accuracy = evidence.accuracy + evidence.guard, error_bound = evidence.error_bound;
  const Tolerance limited = limits_of(tolerance, evidence.is_signed);
  const double farthest = std::max(-lowest, highest);
  const double measured = margin_of(lowest, highest, limited, accuracy);
  const double margin = estimated_signs ? margin_of(-farthest, farthest, limited, accuracy) : measured;
  Judgement result{.nearest_is_lower = limited.lo - lowest > highest - limited.hi};
  if (complete && std::isfinite(margin)) result.margin = margin;
  const map::ToleranceLimits limits(limited, accuracy);
  result.within = complete && !limits.below(lowest) && !limits.above(highest);
  if (!result.within) {
    result.verdict = Verdict::fail;
    result.reason = complete             ? VerdictReason::exceeded
                    : evidence.unmatched ? VerdictReason::without_match
                                         : VerdictReason::beyond_max_distance;
    result.certified =
        !estimated_signs || !complete || farthest - accuracy > std::max(-tolerance.lo, tolerance.hi);
    return result;
  }
  result.certified = lowest <= highest && error_bound <= margin;
  if (result.certified && are_walls_thin(evidence, limited)) {
    result.verdict = Verdict::not_decided, result.reason = VerdictReason::thin_walls;
    result.certified = false;
    return result;
  }
  if (result.certified || (evidence.samples_only && result.margin >= 0.0)) return result;
  result.verdict = Verdict::not_decided;
  result.reason = open_question(evidence, margin, measured);
  if (result.margin > 0.0) result.deciding_bound = *result.margin / 2;
  return result;
}

double largest_limit(const Tolerance& tolerance) {
  double largest = 0;
  for (const double limit : {tolerance.lo, tolerance.hi})
    if (std::isfinite(limit)) largest = std::max(largest, std::abs(limit));
  return largest;
}

ToleranceVerdict summary::check_evidence(const Surface& surface, const DistanceMap& map,
                                         const Evidence& evidence, const Tolerance& tolerance) {
  if (tolerance.needs_sign() && map.sign.method == SignMethod::none)
    throw Error("a tolerance that differs by sign needs signed distances, but these are unsigned: " +
                    map.sign.reason + "; choose another sign method or a symmetric tolerance",
                Remedy::sign_method);
  ToleranceVerdict verdict{judge(evidence, tolerance), tolerance, {}, 0, {}};
  verdict.shares = tolerance_shares(surface, map, tolerance, evidence.accuracy + evidence.guard);
  verdict.exceeded_area_fraction = verdict.shares.below + verdict.shares.above + verdict.shares.without_value;
  if (evidence.complete && evidence.lowest)
    verdict.largest = std::max({0.0, -*evidence.lowest, *evidence.highest});
  return verdict;
}

ToleranceVerdict check_tolerance(const Surface& surface, const DistanceMap& map,
                                 std::span<const float> vertex_distances, double error_bound, double accuracy,
                                 const Tolerance& tolerance) {
  return summary::check_evidence(
      surface, map, evidence_of(surface, map, vertex_distances, error_bound, accuracy), tolerance);
}

double engine_accuracy(const EngineInfo& engine, const Mesh& on, const Mesh& to) {
  Box box = bounds(on);
  extend(box, bounds(to));
  return engine.relative_error * diagonal(box);
}

}  // namespace sdm

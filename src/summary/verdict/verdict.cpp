#include <sdm/error.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>

#include "core/rules.h"
#include "geometry/vec.h"
#include "summary/verdict/evidence.h"

namespace sdm {

Judgement judge(const Evidence& evidence, const Tolerance& tolerance) {
  const double lowest = evidence.lowest.value_or(rules::kInfinity),
               highest = evidence.highest.value_or(-rules::kInfinity);
  const double accuracy = evidence.accuracy + evidence.guard, farthest = std::max(-lowest, highest);
  const double lower = rules::lower_of(tolerance.lower, evidence.is_signed), upper = tolerance.upper;
  const double margin = evidence.estimated_signs
                            ? rules::margin_of(-farthest, farthest, lower, upper, accuracy)
                            : rules::margin_of(lowest, highest, lower, upper, accuracy);
  const double reason = rules::reason_of(lowest, highest, lower, upper, evidence.accuracy, evidence.guard,
                                         evidence.error_bound, evidence.thin_walls, evidence.complete,
                                         evidence.unmatched, evidence.estimated_signs, evidence.samples_only);
  Judgement result{
      .verdict = static_cast<Verdict>(static_cast<int>(rules::verdict_of(reason))),
      .reason = static_cast<VerdictReason>(static_cast<int>(reason)),
      .decision_rule = evidence.uncertainty > 0 ? DecisionRule::iso_14253_1 : DecisionRule::simple_acceptance,
      .nearest_is_lower = lower - lowest > highest - upper};
  result.within = result.verdict != Verdict::fail;
  if (evidence.complete && std::isfinite(margin)) result.margin = margin;
  if (!result.within)
    result.certified = !evidence.estimated_signs || !evidence.complete ||
                       farthest - accuracy > std::max(-tolerance.lower, tolerance.upper);
  else
    result.certified = result.verdict == Verdict::pass && evidence.error_bound <= margin;
  if (result.verdict == Verdict::not_decided && result.reason != VerdictReason::thin_walls &&
      result.margin > 0.0)
    result.deciding_bound = *result.margin / 2;
  return result;
}

bool OptionForm<Tolerance>::read(std::string_view text, const OptionRange& range, Tolerance& value) {
  const std::size_t colon = text.find(':');
  double lo = 0, hi = 0;
  if (!read_number(text.substr(0, colon), range, lo)) return false;
  if (colon != std::string_view::npos && !read_number(text.substr(colon + 1), range, hi)) return false;
  const Tolerance given = colon == std::string_view::npos ? Tolerance(lo) : Tolerance(lo, hi);
  if (!allowed(given, range)) return false;
  value = given;
  return true;
}

std::string OptionForm<Tolerance>::text(const Tolerance& value) {
  return -value.lower == value.upper ? text_of(value.upper)
                                     : text_of(value.lower) + ":" + text_of(value.upper);
}

double largest_limit(const Tolerance& tolerance) {
  return rules::largest_limit(tolerance.lower, tolerance.upper);
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

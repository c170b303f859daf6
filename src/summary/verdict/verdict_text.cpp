#include <sdm/summary.h>

#include "core/numbers/number_text.h"
#include "summary/verdict/limits_words.h"

namespace sdm {
namespace {

std::string short_text(double number, int digits = static_cast<int>(rules::kLimitDigits)) {
  return number_text(number, digits);
}

std::string with_unit(double length, const std::string& units, int digits = 5) {
  return short_text(length, digits) + (units.empty() ? "" : " " + units);
}

/// What a proof adds to its sentence where walls are thin.
constexpr const char* kByFacing =
    " by the faces of the reference that face the same way, as its walls are thin";

/// What a guard band consists of, as a clause.
std::string guard_text(const Evidence& evidence) {
  const char* const deviation = "how far the triangles of CAD were found to be from its surface";
  if (evidence.uncertainty == 0) return std::string(", which is ") + deviation;
  const std::string rule = std::string(" (") + name_of(DecisionRule::iso_14253_1) + ")";
  if (evidence.guard == evidence.uncertainty) return ", which is the uncertainty" + rule;
  return std::string(", which is the uncertainty and ") + deviation + rule;
}

/// Why a verdict is open: no point is proven to be out of the limits.
std::string open_text(const Summary& summary, const std::string& limits) {
  const CertifiedVerdict& verdict = *summary.tolerance;
  switch (verdict.reason) {
    case VerdictReason::nothing_measured:
      return summary.of_points ? "no point is left to measure" : "nothing was measured";
    case VerdictReason::unknown_accuracy:
      return "the accuracy of the distances is unknown";
    case VerdictReason::estimated_signs:
      return "all " + std::string(summary.of_points ? "" : "measured ") + "points are within " + limits +
             ", but their signs are estimates, and with the other sign a point may be out of it";
    case VerdictReason::guard_band:
      return "all " + std::string(summary.evidence.samples_only ? "measured " : "") + "points are within " +
             limits + " or out of it by less than the guard band, " +
             with_unit(summary.evidence.guard, summary.units, 2) + guard_text(summary.evidence) +
             "; one is closer to a limit than that";
    case VerdictReason::between_samples:
      if (verdict.proof) break;
      return "all measured points are within " + limits + ", but points between them may not be";
    default:
      break;
  }
  const std::string accuracy = with_unit(summary.evidence.accuracy, summary.units, 2);
  if (!verdict.proof || !verdict.proof->undecided_by)
    return std::string(summary.evidence.samples_only ? "all measured" : "all") + " points are within " +
           limits + " or out of it by less than the accuracy of a distance, " + accuracy +
           ", which one is closer to a limit than";
  const std::string by = with_unit(*verdict.proof->undecided_by, summary.units, 2);
  if (*verdict.proof->undecided_by > summary.evidence.accuracy)
    return "no point is out of " + limits + " by more than " + by + ", where the search ended";
  return "no point is out of " + limits + " by more than " + by + ", less than the accuracy of a distance, " +
         accuracy;
}

NextSteps after_failure(VerdictReason reason, bool of_thickness) {
  switch (reason) {
    case VerdictReason::beyond_max_distance:
      return {"Something may be missing where there is no value.",
              "A larger --max-distance measures how far these places are."};
    case VerdictReason::without_match:
      return {"A face may be missing, or turned over, where there is no value.",
              "Without --facing and --along, each point is measured to the closest face."};
    default:
      return {
          "It is out of tolerance: look at the places, the largest first, and settle with its maker whether "
          "they matter.",
          of_thickness
              ? ""
              : "A scan that lies beside the part can be aligned (--align), and what is no part of it "
                "left out (--ignore-islands)."};
  }
}

NextSteps while_open(const Summary& summary) {
  const Evidence& evidence = summary.evidence;
  switch (summary.tolerance->reason) {
    case VerdictReason::nothing_measured:
      return {"Nothing is known about it.", "The inputs may be empty, or all of O1 left out."};
    case VerdictReason::unknown_accuracy:
      return {"", "The engines reference and cpu have a known accuracy."};
    case VerdictReason::estimated_signs:
      return {"It is within the limits unless a sign is wrong.",
              "Signs are exact with a closed reference (--weld auto), and do not matter with the same limit "
              "on both "
              "sides."};
    case VerdictReason::guard_band: {
      std::string less;
      if (evidence.uncertainty > 0) less = "a measurement with a smaller uncertainty (--uncertainty)";
      if (evidence.guard > evidence.uncertainty)
        less += std::string(less.empty() ? "" : ", or ") + "finer triangles of CAD (--deflection)";
      return {
          "Neither conformity nor non-conformity is proven: agree with its maker on who bears that, or have "
          "it "
          "measured better.",
          "What may decide: " + less + "."};
    }
    case VerdictReason::within_rounding:
      return {"It is at its limit, to the accuracy of a distance.", ""};
    case VerdictReason::between_samples:
      return {"Points between those that were measured may be out of the limits.",
              "A finer map (--resolution) may decide."};
    default:
      return {};
  }
}

}  // namespace

std::string limits_text(const Tolerance& tolerance, const std::string& units, bool is_signed) {
  const auto text = [](double limit) { return short_text(limit); };
  return summary::limits_words(tolerance, is_signed, text) + (units.empty() ? "" : " " + units);
}

std::string uncertainty_text(double uncertainty, const std::string& units) {
  if (uncertainty == 0) return {};
  return " by more than the uncertainty, " + with_unit(uncertainty, units, 2) + " (" +
         name_of(DecisionRule::iso_14253_1) + ")";
}

std::string verdict_text(const Summary& summary) {
  if (!summary.tolerance) return {};
  const CertifiedVerdict& verdict = *summary.tolerance;
  const std::string limits = limits_text(verdict.tolerance, summary.units, summary.evidence.is_signed);
  const std::string by = uncertainty_text(summary.evidence.uncertainty, summary.units);
  const bool samples_only = summary.evidence.samples_only && !verdict.certified;
  const std::string all = std::string(summary.of_points ? "every point of the cloud"
                                      : samples_only    ? "every measured point of the surface"
                                                        : "every point of the surface") +
                          " is within " + limits +
                          (samples_only ? ", an estimate for those between them" : "");
  switch (verdict.verdict) {
    case Verdict::pass:
      return all + (by.empty() ? "" : ",") + by;
    case Verdict::doubtful:
      return all + ", but " + summary.doubts.front().text + "; " + summary.doubts.front().remedy +
             ", or --accept-doubts";
    case Verdict::fail:
      if (verdict.reason == VerdictReason::without_match)
        return summary.measured.kind == DistanceKind::along
                   ? "no face of the reference that faces the same way is on the line of a point"
                   : "no face of the reference faces as a point does";
      if (verdict.reason == VerdictReason::beyond_max_distance)
        return "a point is farther than the maximum distance";
      return "a point is out of " + limits + by + (verdict.by_facing.value_or(false) ? kByFacing : "");
    case Verdict::not_decided:
      break;
  }
  return open_text(summary, limits);
}

NextSteps next_steps(const Summary& summary) {
  if (!summary.tolerance) return {};
  const CertifiedVerdict& verdict = *summary.tolerance;
  switch (verdict.verdict) {
    case Verdict::pass:
      if (summary.of_points) return {"It may be accepted where the cloud has points.", ""};
      if (verdict.certified) return {"It may be accepted: every point is within the limits.", ""};
      return {
          "It may be accepted as far as it was measured; between the measured points this is an estimate.",
          "A finer map (--resolution) makes the estimate closer."};
    case Verdict::doubtful:
      return {"The doubt has to be settled before it is accepted.", ""};
    case Verdict::fail:
      return after_failure(verdict.reason, summary.of_thickness);
    case Verdict::not_decided:
      break;
  }
  return while_open(summary);
}

}  // namespace sdm

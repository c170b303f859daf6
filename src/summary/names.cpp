#include <sdm/summary.h>

namespace sdm {

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "PASS";
    case Verdict::fail:
      return "FAIL";
    case Verdict::not_decided:
      return "NOT DECIDED";
    case Verdict::doubtful:
      return "DOUBTFUL";
  }
  return "";
}

const char* name_of(VerdictReason reason) {
  switch (reason) {
    case VerdictReason::all_within:
      return "all within";
    case VerdictReason::exceeded:
      return "exceeded";
    case VerdictReason::beyond_max_distance:
      return "beyond max distance";
    case VerdictReason::without_match:
      return "without match";
    case VerdictReason::between_samples:
      return "between samples";
    case VerdictReason::within_rounding:
      return "within rounding";
    case VerdictReason::estimated_signs:
      return "estimated signs";
    case VerdictReason::guard_band:
      return "guard band";
    case VerdictReason::thin_walls:
      return "thin walls";
    case VerdictReason::unknown_accuracy:
      return "unknown accuracy";
    case VerdictReason::nothing_measured:
      return "nothing measured";
    case VerdictReason::in_doubt:
      return "in doubt";
  }
  return "";
}

}  // namespace sdm

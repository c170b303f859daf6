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

const char* name_of(Colormap colormap) {
  switch (colormap) {
    case Colormap::automatic:
      return "automatic";
    case Colormap::viridis:
      return "viridis";
    case Colormap::sequential:
      return "sequential";
    case Colormap::diverging:
      return "diverging";
    case Colormap::paper2006:
      return "paper2006";
  }
  return "";
}

const char* name_of(SignMethod method) {
  switch (method) {
    case SignMethod::automatic:
      return "automatic";
    case SignMethod::none:
      return "none";
    case SignMethod::exact:
      return "exact";
    case SignMethod::winding:
      return "winding";
    case SignMethod::side:
      return "side";
  }
  return "";
}

const char* name_of(DistanceKind kind) {
  switch (kind) {
    case DistanceKind::closest:
      return "closest";
    case DistanceKind::facing:
      return "facing";
    case DistanceKind::along:
      return "along";
    case DistanceKind::thickness:
      return "thickness";
    case DistanceKind::self:
      return "self";
  }
  return "";
}

const char* name_of(AtlasKind kind) {
  switch (kind) {
    case AtlasKind::charts:
      return "charts";
    case AtlasKind::triangles:
      return "triangles";
    case AtlasKind::uv:
      return "uv";
  }
  return "";
}

}  // namespace sdm

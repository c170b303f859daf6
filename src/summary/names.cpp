#include <sdm/summary.h>

#include <cstddef>

#include "core/rules.h"

namespace sdm {

static_assert(rules::kPass == static_cast<int>(Verdict::pass) &&
              rules::kDoubtful == static_cast<int>(Verdict::doubtful) &&
              rules::kThinWalls == static_cast<int>(VerdictReason::thin_walls) &&
              rules::kInDoubt == static_cast<int>(VerdictReason::in_doubt) &&
              rules::kViridisMap == static_cast<int>(Colormap::viridis) &&
              rules::kDivergingMap == static_cast<int>(Colormap::diverging));

const char* name_of(Verdict verdict) {
  return rules::kVerdictNames[static_cast<std::size_t>(verdict)];
}

const char* name_of(VerdictReason reason) {
  return rules::kReasonNames[static_cast<std::size_t>(reason)];
}

}  // namespace sdm

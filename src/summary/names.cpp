#include <sdm/summary.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "core/rules.h"

namespace sdm {

static_assert(rules::kPass == static_cast<int>(Verdict::pass) &&
              rules::kDoubtful == static_cast<int>(Verdict::doubtful) &&
              rules::kThinWalls == static_cast<int>(VerdictReason::thin_walls) &&
              rules::kInDoubt == static_cast<int>(VerdictReason::in_doubt));
static_assert(std::ranges::equal(
    kWords<Colormap>, rules::kColormapNames, {}, [](std::string_view word) { return word; },
    [](std::string_view word) { return word; }));

const char* name_of(Verdict verdict) {
  return rules::kVerdictNames[static_cast<std::size_t>(verdict)];
}

const char* name_of(VerdictReason reason) {
  return rules::kReasonNames[static_cast<std::size_t>(reason)];
}

}  // namespace sdm

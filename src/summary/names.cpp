#include <sdm/mesh.h>
#include <sdm/summary.h>

#include <algorithm>
#include <string_view>

#include "core/rules.h"

namespace sdm {

static_assert(rules::kPass == static_cast<int>(Verdict::pass) &&
              rules::kDoubtful == static_cast<int>(Verdict::doubtful) &&
              rules::kThinWalls == static_cast<int>(VerdictReason::thin_walls) &&
              rules::kInDoubt == static_cast<int>(VerdictReason::in_doubt) &&
              rules::kViridisMap == static_cast<int>(Colormap::viridis) &&
              rules::kDivergingMap == static_cast<int>(Colormap::diverging));

namespace {

template <class Enum>
constexpr bool has_words(const auto& rule) {
  return std::ranges::equal(
      kWords<Enum>, rule, {}, [](std::string_view word) { return word; },
      [](std::string_view word) { return word; });
}
static_assert(has_words<Verdict>(rules::kVerdictNames) && has_words<VerdictReason>(rules::kReasonNames));

}  // namespace

std::optional<double> metres_per(std::string_view unit) {
  for (const auto& [name, metres] : rules::kUnits)
    if (name == unit) return metres;
  return std::nullopt;
}

}  // namespace sdm

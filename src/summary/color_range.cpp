#include <sdm/error.h>
#include <sdm/summary.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rules.h"

namespace sdm {
namespace {

// The distances that a scale is chosen for.
struct Distances {
  double least, most;  // at least as far apart as they are accurate
  double reach;        // of the scale, to either side
  bool few_below, few_above;
};

Distances scaled(const DistanceStatistics& d, double accuracy) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool empty = d.texels == 0;
  const double lo = empty ? 0 : d.min, hi = empty ? 0 : d.max;
  const double least = rules::least_shown(lo, hi, accuracy), most = rules::most_shown(lo, hi, accuracy);
  const double reach = rules::scale_reach(least, most, empty ? kNone : d.p99_abs, accuracy);
  return {.least = least,
          .most = most,
          .reach = reach,
          .few_below = rules::few_below(least, empty ? kNone : d.p05, reach, accuracy),
          .few_above = rules::few_above(most, empty ? kNone : d.p95, reach, accuracy)};
}

std::array<double, 2> rounded(double lo, double hi) {
  return {rules::rounded_lo(lo, hi), rules::rounded_hi(lo, hi)};
}

/// The limits, both the only one if there is but one.
Tolerance finite(const Tolerance& t) {
  return {std::isfinite(t.lower) ? t.lower : t.upper, std::isfinite(t.upper) ? t.upper : t.lower};
}

}  // namespace

ColorRange color_range(const ColorChoice& choice, const DistanceStatistics& distances) {
  if (const auto& t = choice.tolerance;
      t && !(t->lower <= t->upper && std::isfinite(finite(*t).lower) && std::isfinite(finite(*t).upper)))
    throw Error(
        "the tolerance of the picture must be two numbers, the smaller one first, one of them finite");
  if (choice.range && !(std::isfinite((*choice.range)[0]) && std::isfinite((*choice.range)[1]) &&
                        (*choice.range)[0] < (*choice.range)[1]))
    throw Error("the range of the colours must be two finite numbers, the smaller one first");

  // Where nothing was measured, there is no accuracy either.
  const Distances d = scaled(distances, std::isfinite(choice.accuracy) ? choice.accuracy : 0);
  ColorRange result{.colormap = choice.colormap, .chosen = choice.range.has_value()};
  const bool bands = choice.colormap == Colormap::automatic && choice.tolerance;
  double map = static_cast<double>(choice.colormap);
  if (choice.colormap == Colormap::automatic)
    map = rules::automatic_colormap(d.least, d.few_below, d.few_above);
  if (choice.range) {
    result.range = *choice.range;
    if (choice.colormap == Colormap::automatic)
      map = rules::colormap_of_range(map, result.range[0], result.range[1]);
  } else if (bands) {
    const auto& [lower, upper] = *choice.tolerance;
    result.range = rounded(rules::limits_lo(d.least, d.reach, lower, upper),
                           rules::limits_hi(d.most, d.reach, lower, upper));
  } else {
    const bool above = rules::is_longer_above(d.least, d.most, d.few_below, d.few_above);
    result.range = rounded(rules::automatic_lo(map, d.least, d.most, d.reach, above),
                           rules::automatic_hi(map, d.least, d.most, d.reach, above));
  }
  if (!bands) result.colormap = static_cast<Colormap>(map);
  return result;
}

ColorRange widest(const ColorRange& a, const ColorRange& b) {
  ColorRange result = a;
  auto& [lo, hi] = result.range;
  lo = std::min(lo, b.range[0]);
  hi = std::max(hi, b.range[1]);
  const auto one_is = [&](Colormap map) { return a.colormap == map || b.colormap == map; };
  if (one_is(Colormap::sequential) || one_is(Colormap::diverging)) {
    lo = std::min(lo, 0.0);
    hi = std::max(hi, 0.0);
    result.colormap = static_cast<Colormap>(rules::colormap_of_range(rules::kSequentialMap, lo, hi));
  }
  if (result.colormap == Colormap::diverging) {
    hi = std::max(std::abs(lo), std::abs(hi));
    lo = -hi;
  }
  return result;
}

}  // namespace sdm

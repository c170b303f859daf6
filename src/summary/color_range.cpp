#include <sdm/error.h>
#include <sdm/summary.h>

#include <algorithm>
#include <cmath>

#include "summary/round_step.h"

namespace sdm {
namespace {

constexpr double kVanishing = 0.1;    // part of a range in which a diverging scale is nearly white
constexpr double kShorterSide = 0.5;  // of a sequential scale, of the longer one

// The distances that a scale is chosen for.
struct Distances {
  double least, most;         // at least as far apart as they are accurate
  double reach;               // of the scale, to either side
  bool few_below, few_above;  // on that side of 0 is less than 5 % of the area, or nothing far from it
};

Distances scaled(const DistanceStatistics& d, double accuracy) {
  const bool empty = d.texels == 0;
  double lo = empty ? 0 : d.min, hi = empty ? 0 : d.max;
  if (std::max(std::abs(lo), std::abs(hi)) <= accuracy) lo = 0, hi = accuracy;  // rounding
  if (lo < 0 && lo >= -accuracy) lo = 0;
  if (hi > 0 && hi <= accuracy && lo < 0) hi = 0;
  const double reach = !empty && d.p99_abs > accuracy ? d.p99_abs : std::max(std::abs(lo), std::abs(hi));
  return {.least = lo,
          .most = hi,
          .reach = reach,
          .few_below = lo >= 0 || (!empty && d.p05 >= -accuracy) || -lo < kVanishing * reach,
          .few_above = hi <= 0 || (!empty && d.p95 <= accuracy) || hi < kVanishing * reach};
}

Colormap automatic(const Distances& d) {
  if (d.least >= 0) return Colormap::viridis;
  return d.few_below || d.few_above ? Colormap::sequential : Colormap::diverging;
}

// The range from the end of the longer side to that of the shorter one.
std::array<double, 2> sequential(const Distances& d) {
  const bool up = d.few_below == d.few_above ? d.most >= -d.least : d.few_below && d.most > 0;
  const double longer = std::min(d.reach, up ? d.most : -d.least);
  const double shorter = std::min(kShorterSide * longer, std::max(0.0, up ? -d.least : d.most));
  return up ? std::array{-shorter, longer} : std::array{-longer, shorter};
}

/// The limits, both the only one if there is but one.
Tolerance finite(const Tolerance& t) {
  return {std::isfinite(t.lo) ? t.lo : t.hi, std::isfinite(t.hi) ? t.hi : t.lo};
}

std::array<double, 2> banded(const Distances& d, const Tolerance& tolerance) {
  const double margin = std::max(std::abs(tolerance.lo), std::abs(tolerance.hi));
  return {d.least < 0 ? std::min(std::max(d.least, -d.reach), tolerance.lo - margin) : 0,
          std::max(std::clamp(d.most, -d.reach, d.reach), tolerance.hi + margin)};
}

std::array<double, 2> cut(const Distances& d) {
  double lo = std::clamp(d.least, -d.reach, d.reach), hi = std::clamp(d.most, -d.reach, d.reach);
  if (!(lo < hi)) lo = d.least, hi = d.most;  // nearly all of the area has one distance
  if (lo > 0 && (lo < hi / 2 || !(lo < hi))) lo = 0;
  return {lo, hi};
}

std::array<double, 2> rounded(std::array<double, 2> range) {
  auto [lo, hi] = range;
  if (!(lo < hi)) hi = lo + (lo != 0 ? std::abs(lo) : 1);
  const RoundStep step((hi - lo) / kScaleSteps);
  const std::array<double, 2> result{step.below(lo), step.above(hi)};
  // Far from zero, steps of the range may be too small to be numbers.
  return result[0] < result[1] && std::isfinite(result[0]) && std::isfinite(result[1]) ? result
                                                                                       : std::array{lo, hi};
}

}  // namespace

ColorRange color_range(const ColorChoice& choice, const DistanceStatistics& distances) {
  if (const auto& t = choice.tolerance;
      t && !(t->lo <= t->hi && std::isfinite(finite(*t).lo) && std::isfinite(finite(*t).hi)))
    throw Error(
        "the tolerance of the picture must be two numbers, the smaller one first, one of them finite");
  if (choice.range && !(std::isfinite((*choice.range)[0]) && std::isfinite((*choice.range)[1]) &&
                        (*choice.range)[0] < (*choice.range)[1]))
    throw Error("the range of the colours must be two finite numbers, the smaller one first");

  // Where nothing was measured, there is no accuracy either.
  const Distances d = scaled(distances, std::isfinite(choice.accuracy) ? choice.accuracy : 0);
  ColorRange result{.colormap = choice.colormap, .chosen = choice.range.has_value()};
  const bool bands = choice.colormap == Colormap::automatic && choice.tolerance;
  if (choice.colormap == Colormap::automatic && !bands) result.colormap = automatic(d);
  if (choice.range) {
    result.range = *choice.range;
    const auto [lo, hi] = result.range;
    // Both sides of 0 have their colours if neither is short.
    if (choice.colormap == Colormap::automatic && result.colormap == Colormap::sequential &&
        std::min(-lo, hi) > kShorterSide * std::max(-lo, hi))
      result.colormap = Colormap::diverging;
    return result;
  }
  if (bands)
    result.range = rounded(banded(d, finite(*choice.tolerance)));
  else if (result.colormap == Colormap::sequential)
    result.range = rounded(sequential(d));
  else if (result.colormap == Colormap::diverging)
    result.range = rounded({-d.reach, d.reach});
  else
    result.range = rounded(cut(d));
  return result;
}

ColorRange widest(const ColorRange& a, const ColorRange& b) {
  ColorRange result = a;
  auto& [lo, hi] = result.range;
  lo = std::min(lo, b.range[0]), hi = std::max(hi, b.range[1]);
  const auto one_is = [&](Colormap map) { return a.colormap == map || b.colormap == map; };
  if (one_is(Colormap::sequential) || one_is(Colormap::diverging)) {
    lo = std::min(lo, 0.0), hi = std::max(hi, 0.0);
    const bool both = std::min(-lo, hi) > kShorterSide * std::max(-lo, hi);
    result.colormap = both ? Colormap::diverging : Colormap::sequential;
  }
  if (result.colormap == Colormap::diverging) {
    hi = std::max(std::abs(lo), std::abs(hi));
    lo = -hi;
  }
  return result;
}

}  // namespace sdm

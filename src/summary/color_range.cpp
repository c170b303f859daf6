#include <sdm/error.h>
#include <sdm/summary.h>

#include <algorithm>
#include <cmath>

namespace sdm {

ColorRange color_range(const ColorChoice& choice, const DistanceStatistics& distances) {
  if (const auto& t = choice.tolerance;
      t && !(std::isfinite(t->lo) && std::isfinite(t->hi) && t->lo <= t->hi))
    throw Error("the tolerance of the picture must be two finite numbers, the smaller one first");
  if (choice.range && !(std::isfinite((*choice.range)[0]) && std::isfinite((*choice.range)[1]) &&
                        (*choice.range)[0] < (*choice.range)[1]))
    throw Error("the range of the colours must be two finite numbers, the smaller one first");

  const bool empty = distances.texels == 0;
  double lo = empty ? 0 : distances.min, hi = empty ? 0 : distances.max;
  if (std::max(std::abs(lo), std::abs(hi)) <= choice.accuracy) lo = 0, hi = choice.accuracy;  // rounding

  ColorRange result{.colormap = choice.colormap, .chosen = choice.range.has_value()};
  const bool bands = choice.colormap == Colormap::automatic && choice.tolerance;
  if (choice.colormap == Colormap::automatic && !bands)
    result.colormap = lo < 0 && hi > 0 ? Colormap::diverging : Colormap::viridis;
  if (choice.range) {
    result.range = *choice.range;
    return result;
  }

  const double least = lo, most = hi;
  const double reach = !empty && distances.p99_abs > choice.accuracy ? distances.p99_abs
                                                                     : std::max(std::abs(lo), std::abs(hi));
  lo = std::clamp(lo, -reach, reach), hi = std::clamp(hi, -reach, reach);
  if (bands) {
    const double margin = std::max(std::abs(choice.tolerance->lo), std::abs(choice.tolerance->hi));
    hi = std::max(hi, choice.tolerance->hi + margin);
    lo = least < 0 ? std::min(lo, choice.tolerance->lo - margin) : 0;
  } else if (result.colormap == Colormap::diverging) {
    hi = reach, lo = -reach;
  }
  if (!(lo < hi)) lo = least, hi = most;  // nearly all of the area has one distance
  if (!(lo < hi)) hi = lo + (lo != 0 ? std::abs(lo) : 1);
  result.range = {lo, hi};
  return result;
}

ColorRange widest(const ColorRange& a, const ColorRange& b) {
  ColorRange result = a;
  auto& [lo, hi] = result.range;
  lo = std::min(lo, b.range[0]), hi = std::max(hi, b.range[1]);
  if (b.colormap == Colormap::diverging) result.colormap = b.colormap;
  if (result.colormap == Colormap::diverging) {
    hi = std::max(std::abs(lo), std::abs(hi));
    lo = -hi;
  }
  return result;
}

}  // namespace sdm

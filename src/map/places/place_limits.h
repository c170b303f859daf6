// The limits beyond which distances belong to places.
#pragma once

#include <sdm/places.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "map/statistics/tolerance_limits.h"

namespace sdm::map {

/// How far a distance is beyond the limits; not positive within them.
[[nodiscard]] inline double excess(double distance, const Tolerance& limits) {
  return std::max(distance - limits.hi, limits.lo - distance);
}

/// The limits of the tolerance if the least or the largest distance is out of it, and otherwise ±`p99_abs`.
class PlaceLimits {
 public:
  PlaceLimits(const std::optional<Tolerance>& tolerance, double accuracy, double p99_abs, double least,
              double largest)
      : limits_(p99_abs), accuracy_(accuracy) {
    if (!tolerance) return;
    const ToleranceLimits limits(*tolerance, accuracy);
    by_tolerance_ = limits.below(least) || limits.above(largest);
    if (by_tolerance_) limits_ = *tolerance;
  }

  /// 1 above the upper limit, 2 below the lower one, 0 between them and for what is not finite.
  [[nodiscard]] int side(double d) const {
    if (!std::isfinite(d)) return 0;
    if (by_tolerance_) {
      const ToleranceLimits limits(limits_, accuracy_);
      return limits.above(d) ? 1 : limits.below(d) ? 2 : 0;
    }
    if (!(std::abs(d) > accuracy_)) return 0;
    return d >= limits_.hi ? 1 : d <= limits_.lo ? 2 : 0;
  }
  [[nodiscard]] const Tolerance& limits() const { return limits_; }
  [[nodiscard]] bool by_tolerance() const { return by_tolerance_; }

 private:
  Tolerance limits_;
  double accuracy_;
  bool by_tolerance_ = false;
};

}  // namespace sdm::map

// The limits beyond which distances belong to places.
#pragma once

#include <sdm/places.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "map/places/face_tolerances.h"
#include "map/statistics/tolerance_limits.h"

namespace sdm::map {

/// How far a distance is beyond the limits; not positive within them.
[[nodiscard]] inline double excess(double distance, const Tolerance& limits) {
  return std::max(distance - limits.upper, limits.lower - distance);
}

/// Which samples belong to places: those that a tolerance refuses, or where it refuses none, those at or
/// beyond ±`p99_abs`.
class PlaceLimits {
 public:
  PlaceLimits(FaceTolerances tolerances, double accuracy, double p99_abs)
      : tolerances_(std::move(tolerances)), of_all_(p99_abs), accuracy_(accuracy) {}

  /// What is known of a sample before side() is asked. `face`: that has it, or kNone.
  void look(double d, std::uint32_t face) {
    if (by_tolerance_ || !tolerances_.has_any() || refusal(d, face) == 0) return;
    take_tolerances();
  }
  /// Some sample is refused.
  void take_tolerances() { by_tolerance_ = true, of_all_ = tolerances_.of(kNone); }

  /// 1 above the upper limit, 2 below the lower one, 3 without a value although a tolerance asks for one, 0
  /// otherwise.
  [[nodiscard]] int side(double d, std::uint32_t face) const {
    if (by_tolerance_) return refusal(d, face);
    if (!std::isfinite(d) || !(std::abs(d) > accuracy_)) return 0;
    return d >= of_all_.upper ? 1 : d <= of_all_.lower ? 2 : 0;
  }
  /// What samples of one place have in common: side() and the rows that judge the face; 0 if the sample
  /// belongs to no place.
  [[nodiscard]] int kind(double d, std::uint32_t face) const {
    constexpr int kSides = 4;
    const int of_side = side(d, face);
    return of_side == 0 || !by_tolerance_ ? of_side
                                          : of_side + kSides * static_cast<int>(tolerances_.rows_of(face));
  }
  /// Those of a face.
  [[nodiscard]] const Tolerance& limits(std::uint32_t face) const {
    return by_tolerance_ ? tolerances_.of(face) : of_all_;
  }
  /// Those of faces that no row of a table names.
  [[nodiscard]] const Tolerance& of_all() const { return of_all_; }
  [[nodiscard]] bool by_tolerance() const { return by_tolerance_; }

 private:
  [[nodiscard]] int refusal(double d, std::uint32_t face) const {
    const Tolerance& tolerance = tolerances_.of(face);
    if (std::isnan(d)) return tolerance == any_distance() && face != kNone ? 0 : 3;
    if (!std::isfinite(d)) return 0;
    const ToleranceLimits limits(tolerance, accuracy_);
    return limits.above(d) ? 1 : limits.below(d) ? 2 : 0;
  }

  FaceTolerances tolerances_;
  Tolerance of_all_;
  double accuracy_;
  bool by_tolerance_ = false;
};

}  // namespace sdm::map

// The tolerances of the faces of a surface, and the limits beyond which distances belong to places.
#pragma once

#include <sdm/mesh_attributes.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "map/statistics/tolerance_limits.h"

namespace sdm::map {

/// No limit on either side.
inline Tolerance any_distance() {
  return {-kInfinity, kInfinity};
}

/// The tolerance of each face: what all those accept that it is judged by, which are that of the whole
/// surface and those of the rows of a table that name the face.
class FaceTolerances {
 public:
  /// `names`: of the faces. Cost: linear in faces and rows.
  FaceTolerances(const std::optional<Tolerance>& of_all, std::span<const FaceNames> names,
                 std::span<const GroupTolerance> table);

  /// any_distance() of a face that no tolerance judges. Of kNone, that of the whole surface.
  [[nodiscard]] const Tolerance& of(std::uint32_t face) const { return tolerances_[rows_of(face)]; }
  /// A number for each set of rows that name a face; 0 for faces that no row names, and for kNone.
  [[nodiscard]] std::uint32_t rows_of(std::uint32_t face) const {
    return number_.empty() || face == kNone ? 0 : number_[face];
  }
  [[nodiscard]] bool has_any() const { return has_any_; }

 private:
  std::vector<Tolerance> tolerances_;  ///< the first is that of the whole surface
  std::vector<std::uint32_t> number_;  ///< of each face its tolerance; empty: all have the first
  bool has_any_;
};

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

  /// Looks at a sample before side() is asked. `face`: that has it, or kNone.
  void look(double d, std::uint32_t face) {
    if (by_tolerance_ || !tolerances_.has_any() || refusal(d, face) == 0) return;
    take_tolerances();
  }
  /// Some sample is refused.
  void take_tolerances() {
    by_tolerance_ = true;
    of_all_ = tolerances_.of(kNone);
  }

  /// 1 above the upper limit, 2 below the lower one, 3 without a value although a tolerance asks for one, 0
  /// otherwise.
  [[nodiscard]] int side(double d, std::uint32_t face) const {
    if (by_tolerance_) return refusal(d, face);
    if (!std::isfinite(d) || !(std::abs(d) > accuracy_)) return 0;
    return d >= of_all_.upper ? 1 : d <= of_all_.lower ? 2 : 0;
  }
  /// The kind that all samples of one place have: side() and the rows that judge the face; 0 if the sample
  /// belongs to no place.
  [[nodiscard]] int kind(double d, std::uint32_t face) const {
    constexpr int kSides = 4;
    const int of_side = side(d, face);
    return of_side == 0 || !by_tolerance_ ? of_side
                                          : of_side + kSides * static_cast<int>(tolerances_.rows_of(face));
  }
  /// The limits of a face.
  [[nodiscard]] const Tolerance& limits(std::uint32_t face) const {
    return by_tolerance_ ? tolerances_.of(face) : of_all_;
  }
  /// The limits of faces that no row of a table names.
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

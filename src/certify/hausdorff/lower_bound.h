// The largest distance that is known to occur.
#pragma once

#include <algorithm>

#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/side.h"
#include "geometry/vec.h"

namespace sdm::hausdorff {

/// A point of A with the distance to B there.
struct LowerBound {
  double value = -1;        ///< ≤ the largest distance
  Vec3 point{}, closest{};  ///< of A and of B
  std::array<std::uint32_t, 2> faces{kNone, kNone};
  const Side* side = nullptr;  ///< null: points on both sides of B count

  void raise(const LowerBound& other) {
    if (other.value > value) *this = other;
  }
  /// `point` is a point of a face of A, at most `rounding` from it.
  void raise(const Vec3& p, double rounding, std::uint32_t face, const NearestFace& nearest) {
    const double distance = std::max(0.0, nearest.lower - rounding);
    if (distance > value && (side == nullptr || side->has(p, nearest.upper)))
      *this = {distance, p, nearest.point, {face, nearest.face}, side};
  }
};

}  // namespace sdm::hausdorff

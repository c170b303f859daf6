// A ray in the unit frame of O2, in single precision, for conservative tests.
#pragma once

#include <sdm/rays.h>

#include "geometry/unit_frame.h"

namespace sdm::rays {

/// The ray from a point near O2 on: origin + s·direction with s = length·t − skipped, begin ≤ s ≤ end, for
/// all parameters t of the given ray at which it can meet O2.
///
/// `error` bounds the rounding of the origin, of s, and of the parameters of hits, which are rounded to 1e-11
/// of the distance (geometry/line_triangle.h). Boxes are enlarged by it on all sides, by means of two
/// origins, so that they contain every hit as it is rounded.
struct UnitRay {
  float origin[3], direction[3];
  float beyond_lo[3], before_hi[3];  ///< the origin + error, from which lower sides are seen, and − error
  float inverse[3];                  ///< of the direction, finite
  float begin, end, error;
  double length, skipped;

  /// Returns false if the ray cannot meet O2.
  [[nodiscard]] bool place(const Ray& ray, const UnitFrame& frame);
  /// Ends the ray at a hit, which stays in it, as do others at the same t.
  void end_at(double t);
};

}  // namespace sdm::rays

// A bound on the smallest of several convex functions over a triangle.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstdint>
#include <span>

namespace sdm::search {

/// The values of a function at the corners of a triangle.
using CornerValues = Vec3;

struct MixedBound {
  double value = kInfinity;  ///< infinite if there are no functions
  /// Barycentric coordinates of a point where the functions may be as large; 0 where the bound asks for it.
  CornerValues weights{1.0 / 3, 1.0 / 3, 1.0 / 3};
  std::array<std::uint32_t, 3> mixed{kNone, kNone, kNone};  ///< the functions in the mean, others kNone
};

/// Returns an upper bound on the largest value in a triangle of the smallest of several functions, each of
/// which is convex there or linear. A weighted mean of the functions is at least as large as the smallest
/// one, and being convex is largest at a corner. The weights are those of the smallest such bound, by linear
/// programming, whose dual solution is the point at which functions with these values at the corners that
/// are linear are as large as the bound. Stops at a bound of at most `enough`. If no function is negative,
/// the value is at most 7e-16 of itself too small.
[[nodiscard]] MixedBound mixed_bound(std::span<const CornerValues> functions, double enough);

}  // namespace sdm::search

// A bound on the smallest of several convex functions over a triangle.
#pragma once

#include <array>
#include <span>

namespace sdm::depth {

/// The values of a function at the corners of a triangle.
using CornerValues = std::array<double, 3>;

/// Returns an upper bound on the largest value in a triangle of the smallest of several functions, each of
/// which is convex there or linear. A weighted mean of the functions is at least as large as the smallest
/// one, and being convex is largest at a corner; the weights are chosen so that the bound is small. Where one
/// function is largest in one corner and another one in another corner, it is much smaller than the bound by
/// either of them. Stops at a bound of at most `enough`. Infinite if there are no functions.
[[nodiscard]] double mixed_bound(std::span<const CornerValues> functions, double enough);

}  // namespace sdm::depth

// Clipping of convex polygons.
#pragma once

#include <cstddef>
#include <span>

namespace sdm::core {

/// Clips a convex polygon by the half-space in which an affine function is not negative (Sutherland & Hodgman
/// 1974), given by its value at each corner, in order around the polygon. Calls keep(i) for each corner i
/// with a value of at least 0, and
///
///     cut(i, j, t)   t = height[i] / (height[i] − height[j])
///
/// where the side from corner i to the next one, j, passes through 0 between them: at corner i + t (corner j
/// − corner i). The calls are in the order of the corners around the result. A corner at which the value is 0
/// is kept and not repeated, so that a polygon that only touches the half-space results in one or two
/// corners. A cut adds at most one corner to a convex polygon, and at most one for every two corners to any
/// other.
template <class Keep, class Cut>
void clip_convex(std::span<const double> height, const Keep& keep, const Cut& cut) {
  for (std::size_t i = 0; i < height.size(); ++i) {
    const std::size_t j = i + 1 < height.size() ? i + 1 : 0;
    if (height[i] >= 0) keep(i);
    if ((height[i] > 0 && height[j] < 0) || (height[i] < 0 && height[j] > 0))
      cut(i, j, height[i] / (height[i] - height[j]));
  }
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

// Boxes, and what the library needs of vectors beside the arithmetic of sdm/types.h.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <cmath>

namespace sdm::core {

inline bool finite(const Vec3& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

inline void extend(Box& box, const Vec3& p) {
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = std::min(box.lower[k], p[k]);
    box.upper[k] = std::max(box.upper[k], p[k]);
  }
}
inline void extend(Box& box, const Box& other) {
  extend(box, other.lower);
  extend(box, other.upper);
}
inline bool contains(const Box& box, const Vec3& p) {
  for (int k = 0; k < 3; ++k)
    if (!(box.lower[k] <= p[k] && p[k] <= box.upper[k])) return false;
  return true;
}
inline bool overlap(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k)
    if (a.upper[k] < b.lower[k] || b.upper[k] < a.lower[k]) return false;
  return true;
}
/// The distance between two boxes along each axis; 0 where they overlap.
inline Vec3 gap(const Box& a, const Box& b) {
  Vec3 gap;
  for (int k = 0; k < 3; ++k) gap[k] = std::max({a.lower[k] - b.upper[k], b.lower[k] - a.upper[k], 0.0});
  return gap;
}
inline Vec3 centre(const Box& box) {
  return 0.5 * (box.lower + box.upper);
}
inline double diagonal(const Box& box) {
  return norm(box.upper - box.lower);
}

/// The point of the segment from a to b that is closest to x, for a = b as well.
inline Vec3 closest_on_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  const double length = squared_norm(side);
  return length > 0 ? a + std::clamp(dot(x - a, side) / length, 0.0, 1.0) * side : a;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

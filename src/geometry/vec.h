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
    box.lo[k] = std::min(box.lo[k], p[k]);
    box.hi[k] = std::max(box.hi[k], p[k]);
  }
}
inline void extend(Box& box, const Box& other) {
  extend(box, other.lo);
  extend(box, other.hi);
}
inline bool contains(const Box& box, const Vec3& p) {
  for (int k = 0; k < 3; ++k)
    if (!(box.lo[k] <= p[k] && p[k] <= box.hi[k])) return false;
  return true;
}
inline bool overlap(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k)
    if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return false;
  return true;
}
/// The distance between two boxes along each axis; 0 where they overlap.
inline Vec3 gap(const Box& a, const Box& b) {
  Vec3 gap;
  for (int k = 0; k < 3; ++k) gap[k] = std::max({a.lo[k] - b.hi[k], b.lo[k] - a.hi[k], 0.0});
  return gap;
}
inline Vec3 centre(const Box& box) {
  return 0.5 * (box.lo + box.hi);
}
inline double diagonal(const Box& box) {
  return norm(box.hi - box.lo);
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

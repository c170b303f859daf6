// Arithmetic on vectors and boxes.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <cmath>

namespace sdm::core {

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
constexpr Vec3 operator-(const Vec3& a) {
  return {-a[0], -a[1], -a[2]};
}
constexpr Vec3 operator*(double s, const Vec3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) {
  return a = a + b;
}

constexpr Vec2 operator+(const Vec2& a, const Vec2& b) {
  return {a[0] + b[0], a[1] + b[1]};
}
constexpr Vec2 operator-(const Vec2& a, const Vec2& b) {
  return {a[0] - b[0], a[1] - b[1]};
}
constexpr Vec2 operator*(double s, const Vec2& a) {
  return {s * a[0], s * a[1]};
}

constexpr double dot(const Vec2& a, const Vec2& b) {
  return a[0] * b[0] + a[1] * b[1];
}
constexpr double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
constexpr double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
constexpr double squared_norm(const Vec3& a) {
  return dot(a, a);
}
inline double norm(const Vec3& a) {
  return std::sqrt(dot(a, a));
}
inline bool finite(const Vec3& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

/// a / |a|, or the zero vector if a is zero.
inline Vec3 normalized(const Vec3& a) {
  const double length = norm(a);
  return length > 0 ? (1 / length) * a : Vec3{};
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

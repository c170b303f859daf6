#include "map/measures/touching_ball.h"

#include <algorithm>
#include <cmath>

namespace sdm::thickness {
namespace {

constexpr double kRounding = 1e-15;  // relative, of a point that is p itself

void reach_point(const Vec3& n, const Vec3& q, double size, TouchedPoint& least) {
  const double height = dot(n, q), squared = squared_norm(q);
  double radius = kInfinity;
  if (height > 0)
    radius = squared / (2 * height);
  else if (squared <= kRounding * kRounding * size)
    radius = 0;
  if (radius < least.radius) least = {radius, q};
}

// The radius on a line a + s d, with α = n·a and β = n·d, is convex where w = α + β s > 0, with its minimum
// at
//   D β s² + 2 D α s + 2 (a·d) α − β |a|² = 0,  D = |d|²,
// whose discriminant is D |β a − α d|²: w = |β a − α d| / √D there. Of the two forms of the root, each sums
// terms of the same sign only.
void reach_segment(const Vec3& n, const Vec3& a, const Vec3& b, TouchedPoint& least) {
  const Vec3 d = b - a;
  const double alpha = dot(n, a), beta = dot(n, d);
  if (alpha <= 0 && alpha + beta <= 0) return;
  const double squared = squared_norm(d), root = std::sqrt(squared) * norm(beta * a - alpha * d);
  double s = 0;
  if (alpha > 0) {
    const double below = squared * alpha + root;
    if (below > 0) s = (beta * squared_norm(a) - 2 * alpha * dot(a, d)) / below;
  } else {
    s = (root / squared - alpha) / beta;  // beta > −alpha ≥ 0
  }
  reach_point(n, a + std::clamp(s, 0.0, 1.0) * d, squared_norm(a) + squared, least);
}

// The plane m·q = h ≥ 0 is reached at q = r (n + m), where h = r (m·n + 1) = r |n + m|² / 2.
void reach_interior(const Vec3& n, const Corners& corners, TouchedPoint& least) {
  const auto& [a, b, c] = corners;
  Vec3 m = cross(b - a, c - a);
  const double size = norm(m);
  if (size == 0) return;
  m = (1 / size) * m;
  const Vec3 normal = m;
  double h = dot(m, a);
  if (h < 0) {
    m = -1.0 * m;
    h = -h;
  }
  const Vec3 sum = n + m;
  const double squared = squared_norm(sum);
  if (squared == 0) return;
  const double radius = 2 * h / squared;
  if (!(radius < least.radius)) return;
  const Vec3 q = radius * sum;
  const auto left_of = [&](const Vec3& from, const Vec3& to) {
    return dot(cross(to - from, q - from), normal) >= 0;
  };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a)) least = {radius, q};
}

}  // namespace

TouchedPoint smallest_ball(const Touching& ball, const Corners& corners) {
  const auto& [p, n] = ball;
  const Corners from{corners[0] - p, corners[1] - p, corners[2] - p};
  TouchedPoint least;
  if (std::ranges::none_of(from, [&n = n](const Vec3& q) { return dot(n, q) > 0; })) return least;
  for (int k = 0; k < 3; ++k) reach_segment(n, from[k], from[(k + 1) % 3], least);
  reach_interior(n, from, least);
  least.point = least.point + p;
  return least;
}

}  // namespace sdm::thickness

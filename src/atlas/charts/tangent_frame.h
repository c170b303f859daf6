// Planes and convex hulls in them.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sdm::atlas {

/// Unit vectors (right, up) such that right, up and the unit axis form a right-handed frame.
inline std::array<Vec3, 2> tangent_frame(const Vec3& axis) {
  const Vec3 other = std::abs(axis[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 right = normalized(cross(other, axis));
  return {right, cross(axis, right)};
}

/// Removes points inside the polygon of those that are extreme in eight directions: most of many points (Akl
/// & Toussaint 1978).
template <class Point, class At>
void remove_inner_points(std::vector<Point>& points, At at) {
  constexpr std::array<Vec2, 8> kDirections{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  std::array<Vec2, 8> corners;
  for (std::size_t k = 0; k < 8; ++k)
    corners[k] = at(*std::max_element(points.begin(), points.end(), [&](const Point& p, const Point& q) {
      return dot(kDirections[k], at(p)) < dot(kDirections[k], at(q));
    }));
  // A direction may have the corner of the one before.
  const auto end = std::unique(corners.begin(), corners.end());
  std::erase_if(points, [&](const Point& point) {
    const Vec2& p = at(point);
    for (auto a = corners.begin(); a != end; ++a) {
      const Vec2& b = a + 1 == end ? corners[0] : a[1];
      if (b != *a && !(cross(b - *a, p - *a) > 0)) return false;
    }
    return end - corners.begin() > 2;
  });
}

/// The corners of the convex hull, counter-clockwise (Andrew's monotone chain). `at` returns the position of
/// a point. Points are ordered by their positions first; the first of several at one position is kept.
template <class Point, class At>
std::vector<Point> convex_hull(std::vector<Point> points, At at) {
  constexpr std::size_t kMany = 64;
  if (points.size() > kMany) remove_inner_points(points, at);
  const auto same = [&](const Point& p, const Point& q) { return at(p) == at(q); };
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  if (points.size() < 3) return points;
  std::vector<Point> hull;
  const auto chain = [&](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= base + 2 &&
             cross(at(hull.back()) - at(hull[hull.size() - 2]), at(*p) - at(hull.back())) <= 0)
        hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
  return hull;
}

}  // namespace sdm::atlas

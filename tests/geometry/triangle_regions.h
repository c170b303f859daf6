// Points in all regions around triangles of all shapes.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "geometry/point_triangle.h"

namespace sdm::test {

struct Shape {
  std::string name;
  Corners corners;
  bool flat;  ///< has an interior that is wider than rounding
};

inline const std::vector<Shape> kShapes = {
    {"acute", {{{0, 0, 0}, {2, 0, 0}, {0.75, 1.5, 0}}}, true},
    {"right", {{{0, 0, 0}, {3, 0, 0}, {0, 1, 0}}}, true},
    {"obtuse", {{{0, 0, 0}, {1, 0, 0}, {-2, 0.5, 0}}}, true},
    {"almost flat angle", {{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-3, 0}}}, true},
    {"short side", {{{0, 0, 0}, {1, 0, 0}, {1, 1e-3, 0}}}, true},
    {"needle", {{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-15, 0}}}, false},
    {"needle with a short side", {{{0, 0, 0}, {1, 0, 0}, {1, 1e-15, 0}}}, false},
    {"collinear", {{{0, 0, 0}, {1, 0, 0}, {0.25, 0, 0}}}, false},
    {"collinear, the middle first", {{{0.25, 0, 0}, {0, 0, 0}, {1, 0, 0}}}, false},
    {"two equal corners", {{{0, 0, 0}, {0, 0, 0}, {1, 0.5, 0}}}, false},
    {"point", {{{0.5, 0.5, 0}, {0.5, 0.5, 0}, {0.5, 0.5, 0}}}, false},
};

/// A point whose closest feature is known.
struct RegionPoint {
  Vec3 p, closest;
  TriangleFeature feature;
  int index;
};

/// In each region of a triangle with an interior: near, far, and on both sides of its plane.
inline std::vector<RegionPoint> points_in_regions(const Corners& t) {
  std::vector<RegionPoint> points;
  const Vec3 normal = normalized(cross(t[1] - t[0], t[2] - t[0]));
  const double size = norm(t[1] - t[0]);
  for (const double height : {0.0, 1e-3, -0.5, 20.0}) {
    const Vec3 up = height * size * normal;
    for (const double beyond : {1e-3, 0.5, 20.0})
      for (int k = 0; k < 3; ++k) {
        const Vec3 &a = t[k], &b = t[(k + 1) % 3], &c = t[(k + 2) % 3];
        // The angle between both directions to p and to either neighbour is at least a right one.
        const Vec3 away = normalized(a - b) + normalized(a - c);
        points.push_back({a + beyond * size * away + up, a, TriangleFeature::corner, k});
        for (const double s : {0.1, 0.6}) {
          const Vec3 foot = a + s * (b - a), outward = normalized(cross(b - a, normal));
          points.push_back({foot + beyond * size * outward + up, foot, TriangleFeature::side, k});
        }
      }
    for (const Vec3& w : {Vec3{0.25, 0.25, 0.5}, Vec3{0.8, 0.1, 0.1}, Vec3{0.1, 0.45, 0.45}}) {
      const Vec3 foot = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
      points.push_back({foot + up, foot, TriangleFeature::interior, 0});
    }
  }
  return points;
}

/// Rotated, moved and scaled: calls visit(corners) some times.
inline void for_each_placement(const Corners& shape, const std::function<void(const Corners&)>& visit) {
  visit(shape);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double scale : {1e-3, 1.0, 1e5}) {
    const Vec3 x = normalized({normal(random), normal(random), normal(random)}),
               y = normalized(cross(x, {normal(random), normal(random), normal(random)})), z = cross(x, y);
    Corners placed;
    for (int k = 0; k < 3; ++k)
      placed[k] = scale * (Vec3{1, -2, 3} + shape[k][0] * x + shape[k][1] * y + shape[k][2] * z);
    visit(placed);
  }
}

/// The largest coordinate: rounding is relative to it.
inline double largest_coordinate(const Corners& t, const Vec3& p) {
  double largest = 0;
  for (const Vec3& v : {t[0], t[1], t[2], p})
    for (const double x : v) largest = std::max(largest, std::abs(x));
  return largest;
}

}  // namespace sdm::test

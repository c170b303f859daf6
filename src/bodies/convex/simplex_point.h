// Simplices of differences of vertices, and their points closest to the origin.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace sdm::convex {

/// A vertex of O1 and one of O2, and their difference in the frame of O1.
struct SimplexPoint {
  std::array<std::uint32_t, 2> vertices{};
  Vec3 w{};
};

/// Up to four points, the last one added last.
struct SimplexPoints {
  std::array<SimplexPoint, 4> points;
  int count = 0;

  void add(const SimplexPoint& p) { points[count++] = p; }

  /// Keeps the points of the smallest face that contains the point `v` closest to the origin. Returns whether
  /// there is one: not if four points enclose the origin, which are kept.
  bool reduce(Vec3& v) {
    switch (count) {
      case 1:
        v = points[0].w;
        return true;
      case 2:
        return keep(of_segment(0, 1), v);
      case 3:
        return keep(of_triangle(0, 1, 2), v);
      default:
        return reduce_tetrahedron(v);
    }
  }

  /// Keeps three of four points: those whose plane is nearest to the origin. Returns its unit normal, away
  /// from the point left out; 0 if no three points have a plane.
  Vec3 keep_nearest_face() {
    double least = kInfinity;
    int farthest = 3;
    Vec3 outwards{};
    for (int i = 0; i < 4; ++i) {
      const Vec3 &a = w((i + 1) % 4), n = cross(w((i + 2) % 4) - a, w((i + 3) % 4) - a);
      const double length = norm(n), distance = std::abs(dot(n, a)) / length;
      if (!(distance < least)) continue;
      least = distance;
      farthest = i;
      outwards = ((dot(n, w(i) - a) > 0 ? -1 : 1) / length) * n;
    }
    for (int i = farthest; i < 3; ++i) points[i] = points[i + 1];
    count = 3;
    return outwards;
  }

  /// The distance of the origin from the nearest plane of four points that enclose it, at most; negative if
  /// they do not.
  [[nodiscard]] double depth_of_origin() const {
    double least = kInfinity;
    for (int i = 0; i < 4; ++i) {
      const Vec3 &a = w(i), &b = w((i + 1) % 4), &c = w((i + 2) % 4), &d = w((i + 3) % 4);
      const Vec3 n = cross(b - a, c - a);
      const double length = norm(n), inner = dot(n, d - a), origin = -dot(n, a);
      if (!(length > 0) || !(inner * origin > 0)) return -1;
      // Normals of slivers are not reliable.
      const double sides = std::max({squared_norm(b - a), squared_norm(c - a), squared_norm(c - b)});
      least = std::min(least, std::abs(origin) / length - kSliver * sides / length * norm(a));
    }
    return least;
  }

 private:
  static constexpr double kSliver = 1e-15;

  struct Nearest {
    double squared = kInfinity;
    Vec3 v{};
    int count = 0;
    std::array<int, 3> kept{};
  };
  [[nodiscard]] const Vec3& w(int i) const { return points[i].w; }

  [[nodiscard]] Nearest of_point(int i) const { return {squared_norm(w(i)), w(i), 1, {i, 0, 0}}; }
  [[nodiscard]] Nearest of_segment(int i, int j) const {
    const Vec3 side = w(j) - w(i);
    const double t = -dot(w(i), side), length = squared_norm(side);
    if (!(t > 0)) return of_point(i);
    if (!(t < length)) return of_point(j);
    const Vec3 v = w(i) + (t / length) * side;
    return {squared_norm(v), v, 2, {i, j, 0}};
  }
  // Distinguishes the regions of the triangle (Ericson, Real-Time Collision Detection, 5.1.5).
  [[nodiscard]] Nearest of_triangle(int i, int j, int k) const {
    const Vec3 &a = w(i), &b = w(j), &c = w(k);
    const Vec3 ab = b - a, ac = c - a;
    const double d1 = -dot(ab, a), d2 = -dot(ac, a);
    if (d1 <= 0 && d2 <= 0) return of_point(i);
    const double d3 = -dot(ab, b), d4 = -dot(ac, b);
    if (d3 >= 0 && d4 <= d3) return of_point(j);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return of_segment(i, j);
    const double d5 = -dot(ab, c), d6 = -dot(ac, c);
    if (d6 >= 0 && d5 <= d6) return of_point(k);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return of_segment(i, k);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return of_segment(j, k);
    const Vec3 n = cross(ab, ac);
    const Vec3 v = (dot(n, a) / squared_norm(n)) * n;
    return {squared_norm(v), v, 3, {i, j, k}};
  }
  bool keep(const Nearest& nearest, Vec3& v) {
    for (int i = 0; i < nearest.count; ++i)  // in increasing order
      if (nearest.kept[i] != i) points[i] = points[nearest.kept[i]];
    count = nearest.count;
    v = nearest.v;
    return true;
  }
  // The origin is not beyond the face that the last point was seen from.
  bool reduce_tetrahedron(Vec3& v) {
    Nearest nearest;
    constexpr int kFaces[3][4] = {{0, 1, 3, 2}, {1, 2, 3, 0}, {0, 2, 3, 1}};
    for (const auto& [i, j, k, opposite] : kFaces) {
      const Vec3 n = cross(w(j) - w(i), w(k) - w(i));
      const double inner = dot(n, w(opposite) - w(i)), origin = -dot(n, w(i));
      if (inner * origin > 0) continue;
      if (const Nearest found = of_triangle(i, j, k); found.squared < nearest.squared) nearest = found;
    }
    return nearest.count > 0 && keep(nearest, v);
  }
};

}  // namespace sdm::convex

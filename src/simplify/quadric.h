// Quadric errors: sums of weighted squared distances to planes (Garland and Heckbert 1997).
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <array>

namespace sdm::simplify {

/// Σ w (n·x − d)² for planes n·x = d with |n| = 1: xᵀ A x − 2 b·x + c.
struct Quadric {
  std::array<double, 6> a{};  ///< xx, xy, xz, yy, yz, zz
  Vec3 b{};
  double c = 0;
  double weight = 0;  ///< Σ w

  void add_plane(const Vec3& n, double d, double w) {
    const std::array products{n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2], n[2] * n[2]};
    for (int k = 0; k < 6; ++k) a[k] += w * products[k];
    b = b + (w * d) * n;
    c += w * d * d;
    weight += w;
  }
  Quadric& operator+=(const Quadric& other) {
    for (int k = 0; k < 6; ++k) a[k] += other.a[k];
    b = b + other.b;
    c += other.c;
    weight += other.weight;
    return *this;
  }
  [[nodiscard]] Vec3 times(const Vec3& x) const {
    return {a[0] * x[0] + a[1] * x[1] + a[2] * x[2], a[1] * x[0] + a[3] * x[1] + a[4] * x[2],
            a[2] * x[0] + a[4] * x[1] + a[5] * x[2]};
  }
  /// Not less than 0.
  [[nodiscard]] double at(const Vec3& x) const { return std::max(0.0, dot(x, times(x) - 2 * b) + c); }

  /// The minimum, drawn towards a point by a share of the trace that decides only where planes do not: along
  /// flat surfaces and straight edges.
  [[nodiscard]] Vec3 minimum(const Vec3& towards) const {
    constexpr double kDrawn = 1e-4;
    const double e = kDrawn * (a[0] + a[3] + a[5]);
    if (!(e > 0)) return towards;
    // (A + e I) y = b − A t, with y = x − t, by cofactors: A + e I is positive definite.
    const Vec3 r = b - times(towards);
    const double xx = a[0] + e, xy = a[1], xz = a[2], yy = a[3] + e, yz = a[4], zz = a[5] + e;
    const double cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - xz * yy;
    const double cyy = xx * zz - xz * xz, cyz = xy * xz - xx * yz, czz = xx * yy - xy * xy;
    const double determinant = xx * cxx + xy * cxy + xz * cxz;
    const Vec3 y{cxx * r[0] + cxy * r[1] + cxz * r[2], cxy * r[0] + cyy * r[1] + cyz * r[2],
                 cxz * r[0] + cyz * r[1] + czz * r[2]};
    return towards + (1 / determinant) * y;
  }
};

}  // namespace sdm::simplify

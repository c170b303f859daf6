// Which texel centres lie in a triangle of the atlas.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace sdm::atlas {

/// Twice the signed area of (a, b, p), evaluated identically, up to the sign, for the edge (b, a): where two
/// triangles share an edge, a point beside it is on exactly one side.
inline double edge_side(const Vec2& a, const Vec2& b, const Vec2& p) {
  return a < b ? cross(b - a, p - a) : -cross(a - b, p - b);
}

/// Whether p belongs to the triangle (cross(b − a, c − a) > 0): inside, or on an edge that runs towards +y,
/// or towards −x along a row. Of two triangles on both sides of an edge, exactly one has the points on it.
inline bool owns(const std::array<Vec2, 3>& t, const Vec2& p) {
  for (int k = 0; k < 3; ++k) {
    const Vec2 &a = t[k], &b = t[(k + 1) % 3];
    const double side = edge_side(a, b, p);
    const bool keeps_edge = b[1] > a[1] || (b[1] == a[1] && b[0] < a[0]);
    if (side < 0 || (side == 0 && !keeps_edge)) return false;
  }
  return true;
}

/// Calls visit(x, y) for every texel whose centre (x + ½, y + ½) belongs to the triangle; its coordinates are
/// ≥ 0 and below 2^31. Triangles without area own nothing. Cost: O(rows + texels).
template <class Visit>
void for_each_centre(std::array<Vec2, 3> t, Visit visit) {
  const double area = edge_side(t[0], t[1], t[2]);
  if (!(area != 0)) return;
  if (area < 0) std::swap(t[1], t[2]);
  const auto [lo, hi] = std::minmax({t[0][1], t[1][1], t[2][1]});
  for (auto y = static_cast<std::int64_t>(std::ceil(lo - 0.5)); static_cast<double>(y) + 0.5 <= hi; ++y) {
    const double row = static_cast<double>(y) + 0.5;
    double left = kInfinity, right = -left;
    for (int k = 0; k < 3; ++k) {
      const Vec2 &a = t[k], &b = t[(k + 1) % 3];
      if (std::min(a[1], b[1]) > row || std::max(a[1], b[1]) < row) continue;
      const double at = a[1] == b[1] ? 0 : std::clamp((row - a[1]) / (b[1] - a[1]), 0.0, 1.0);
      const double x = a[0] + at * (b[0] - a[0]), other = a[1] == b[1] ? b[0] : x;
      left = std::min({left, x, other});
      right = std::max({right, x, other});
    }
    // The interval is rounded, but the decision is not: one more centre is tested at both ends.
    const auto last = static_cast<std::int64_t>(std::ceil(right - 0.5));
    for (auto x = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(left - 0.5))); x <= last;
         ++x)
      if (owns(t, {static_cast<double>(x) + 0.5, row}))
        visit(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  }
}

}  // namespace sdm::atlas

#include "inside/near_faces.h"

#include <algorithm>
#include <utility>

#include "hierarchy/traverse.h"

namespace sdm::inside {
namespace {

// The extent of points along an axis.
template <std::size_t N>
std::pair<double, double> extent(const std::array<Vec3, N>& points, const Vec3& axis) {
  std::pair<double, double> range{dot(points[0], axis), dot(points[0], axis)};
  for (std::size_t i = 1; i < N; ++i) {
    const double along = dot(points[i], axis);
    range = {std::min(range.first, along), std::max(range.second, along)};
  }
  return range;
}

// Triangles that share a corner, as unit vectors from there to the others: whether a plane through the
// corner separates them by kClearAngle.
bool apart_at_corner(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  constexpr double kRounding = 1e-12;
  const auto separates = [&](const Vec3& direction) {
    const Vec3 axis = normalized(direction);
    const auto [a_least, a_most] = extent(a, axis);
    const auto [b_least, b_most] = extent(b, axis);
    return (a_least > -kRounding && b_most < -kClearAngle) || (a_least > kClearAngle && b_most < kRounding) ||
           (b_least > -kRounding && a_most < -kClearAngle) || (b_least > kClearAngle && a_most < kRounding);
  };
  if (separates(a[0] + a[1] - b[0] - b[1])) return true;
  const Vec3 a_normal = cross(a[0], a[1]), b_normal = cross(b[0], b[1]);
  if (separates(a_normal) || separates(b_normal)) return true;
  for (int i = 0; i < 2; ++i)
    if (separates(cross(a[i], a_normal)) || separates(cross(b[i], b_normal))) return true;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if (separates(cross(a[i], b[j]))) return true;
  return false;
}

// Triangles on both sides of the edge from p to q, with third corners c and d: whether they form an angle
// larger than kClearAngle.
bool unfolded(const Vec3& p, const Vec3& q, const Vec3& c, const Vec3& d) {
  const Vec3 along = normalized(q - p);
  const auto inward = [&](const Vec3& corner) {
    const Vec3 r = corner - p;
    return normalized(r - dot(r, along) * along);
  };
  return norm(inward(c) - inward(d)) > kClearAngle;
}

bool boxes_apart(const Corners& a, const Corners& b) {
  for (int k = 0; k < 3; ++k)
    if (std::max({a[0][k], a[1][k], a[2][k]}) + kClearance < std::min({b[0][k], b[1][k], b[2][k]}) ||
        std::max({b[0][k], b[1][k], b[2][k]}) + kClearance < std::min({a[0][k], a[1][k], a[2][k]}))
      return true;
  return false;
}

bool faces_apart(const sites::SitesData& sites, std::uint32_t face, const Corners& at, std::uint32_t other) {
  const Corners other_at = unit_corners(sites, other);
  if (boxes_apart(at, other_at)) return true;
  const Triangle &a = sites.mesh.triangles[face], &b = sites.mesh.triangles[other];
  std::array<int, 3> mine{}, theirs{};  // the shared corners, then the others
  int shared = 0, own = 2;
  for (int i = 0; i < 3; ++i) {
    const auto j = std::find(b.begin(), b.end(), a[i]) - b.begin();
    if (j == 3)
      mine[own--] = i;
    else
      mine[shared] = i, theirs[shared++] = static_cast<int>(j);
  }
  own = 2;
  for (int j = 0; j < 3; ++j)
    if (std::find(theirs.begin(), theirs.begin() + shared, j) == theirs.begin() + shared) theirs[own--] = j;
  switch (shared) {
    case 0:
      return apart(at, other_at);
    case 1: {
      const Vec3& corner = at[mine[0]];
      const auto from_corner = [&](const Vec3& p) { return normalized(p - corner); };
      return apart_at_corner({from_corner(at[mine[1]]), from_corner(at[mine[2]])},
                             {from_corner(other_at[theirs[1]]), from_corner(other_at[theirs[2]])});
    }
    case 2:
      return unfolded(at[mine[0]], at[mine[1]], at[mine[2]], other_at[theirs[2]]);
    default:
      return false;
  }
}

}  // namespace

Corners unit_corners(const sites::SitesData& sites, std::uint32_t face) {
  const auto& [a, b, c] = sites.mesh.triangles[face];
  const std::vector<Vec3>& p = sites.mesh.positions;
  return {sites.frame.to_unit(p[a]), sites.frame.to_unit(p[b]), sites.frame.to_unit(p[c])};
}

// The axes are those of the separating axis theorem for triangles in space and in one plane.
bool apart(const Corners& a, const Corners& b) {
  const auto separates = [&](const Vec3& axis) {
    const auto [a_least, a_most] = extent(a, axis);
    const auto [b_least, b_most] = extent(b, axis);
    const double gap = std::max(a_least - b_most, b_least - a_most);
    return gap > 0 && gap * gap > kClearance * kClearance * squared_norm(axis);
  };
  std::array<Vec3, 3> a_edge, b_edge;
  for (int i = 0; i < 3; ++i) a_edge[i] = a[(i + 1) % 3] - a[i], b_edge[i] = b[(i + 1) % 3] - b[i];
  const Vec3 a_normal = cross(a_edge[0], a_edge[1]), b_normal = cross(b_edge[0], b_edge[1]);
  if (separates(a_normal) || separates(b_normal)) return true;
  for (int i = 0; i < 3; ++i)
    if (separates(cross(a_edge[i], a_normal)) || separates(cross(b_edge[i], b_normal))) return true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (separates(cross(a_edge[i], b_edge[j]))) return true;
  return false;
}

void find_near_faces(const sites::SitesData& sites, std::uint32_t face, std::vector<std::uint32_t>& near) {
  near.clear();
  const Corners at = unit_corners(sites, face);
  std::array<float, 3> lo, hi;
  for (int k = 0; k < 3; ++k) {
    constexpr double kMargin = 2 * kClearance;  // with rounding to float
    lo[k] = static_cast<float>(std::min({at[0][k], at[1][k], at[2][k]}) - kMargin);
    hi[k] = static_cast<float>(std::max({at[0][k], at[1][k], at[2][k]}) + kMargin);
  }
  traverse(
      sites.tree, whole(sites.tree),
      [&](hierarchy::Subtree below) {
        const hierarchy::FloatBox& box = sites.tree.box(below.root);
        for (int k = 0; k < 3; ++k)
          if (box.hi[k] < lo[k] || hi[k] < box.lo[k]) return false;
        return true;
      },
      [&](std::uint32_t leaf) {
        for (const std::uint32_t other : sites.tree.items_of(leaf))
          if (other != face && !faces_apart(sites, face, at, other)) near.push_back(other);
      });
}

}  // namespace sdm::inside

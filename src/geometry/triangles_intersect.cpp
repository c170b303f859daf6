// Intersection of triangles, decided by the signs of orientations only, which are exact.
#include "geometry/predicates.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"

namespace sdm::core {
namespace {

using Signs = std::array<int, 3>;

// The sides of t's plane on which three points lie; 0 if t has no plane.
Signs sides(const Corners& t, const Corners& points) {
  const OrientedPlane plane(t[0], t[1], t[2]);
  return {plane.side(points[0]), plane.side(points[1]), plane.side(points[2])};
}
bool one_sided(const Signs& s) {
  return s[0] * s[1] > 0 && s[1] * s[2] > 0;
}
bool agree(const Signs& s) {
  return !(s[0] > 0 || s[1] > 0 || s[2] > 0) || !(s[0] < 0 || s[1] < 0 || s[2] < 0);
}

// Whether the line through p and q, which crosses the plane of t at one point, crosses it within t.
bool line_meets(const Vec3& p, const Vec3& q, const Corners& t) {
  const int first = orientation(p, q, t[0], t[1]), second = orientation(p, q, t[1], t[2]);
  if (first * second < 0) return false;
  return agree({first, second, orientation(p, q, t[2], t[0])});
}

// Whether an edge of `edges` that crosses the plane of t, or ends on it, meets t. `side`: those of its
// corners.
bool any_edge_meets(const Corners& edges, const Signs& side, const Corners& t) {
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const bool crosses = side[k] * side[next] <= 0 && side[k] != side[next];
    if (crosses && line_meets(edges[k], edges[next], t)) return true;
  }
  return false;
}

struct Corners2 {
  Vec2 at[3];

  Corners2(const Corners& t, int dropped) {
    for (int k = 0; k < 3; ++k) at[k] = {t[k][(dropped + 1) % 3], t[k][(dropped + 2) % 3]};
  }
};

bool boxes_meet(const Vec2& p, const Vec2& q, const Vec2& r, const Vec2& s) {
  for (int k = 0; k < 2; ++k)
    if (std::max(p[k], q[k]) < std::min(r[k], s[k]) || std::max(r[k], s[k]) < std::min(p[k], q[k]))
      return false;
  return true;
}
bool segments_meet(const Vec2& p, const Vec2& q, const Vec2& r, const Vec2& s) {
  return boxes_meet(p, q, r, s) && orientation(p, q, r) * orientation(p, q, s) <= 0 &&
         orientation(r, s, p) * orientation(r, s, q) <= 0;
}

// A triangle without area has no interior, only edges.
bool holds(const Corners2& t, const Vec2& p) {
  const auto& [a, b, c] = t.at;
  return orientation(a, b, c) != 0 &&
         agree({orientation(a, b, p), orientation(b, c, p), orientation(c, a, p)});
}

bool meet(const Corners2& a, const Corners2& b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (segments_meet(a.at[i], a.at[(i + 1) % 3], b.at[j], b.at[(j + 1) % 3])) return true;
  return holds(a, b.at[0]) || holds(b, a.at[0]);
}

// Coplanar triangles, or triangles without a plane.
bool flat_intersect(const Corners& a, const Corners& b) {
  // Two triangles without a plane: segments, which may be skew.
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (orientation(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]) != 0) return false;
  // All points lie in one plane. A projection along an axis preserves disjointness unless it collapses the
  // plane to a line, or the line to a point; at least one of the three axes does not.
  for (int axis = 0; axis < 3; ++axis)
    if (!meet(Corners2(a, axis), Corners2(b, axis))) return false;
  return true;
}

}  // namespace

bool triangles_intersect(const Corners& a, const Corners& b) {
  if (squared_box_distance(a, b) > 0) return false;
  const Signs b_sides = sides(a, b);
  if (one_sided(b_sides)) return false;
  const Signs a_sides = sides(b, a);
  if (one_sided(a_sides)) return false;
  if (b_sides == Signs{} && a_sides == Signs{}) return flat_intersect(a, b);
  // The line in which the planes intersect cuts both triangles (or one of them is a segment). If the cuts
  // overlap, one of them has an endpoint in the other: a point where an edge of one triangle, not in the
  // plane of the other, meets it.
  return any_edge_meets(b, b_sides, a) || any_edge_meets(a, a_sides, b);
}

}  // namespace sdm::core

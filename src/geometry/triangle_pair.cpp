// Intersection of triangles, decided by the signs of orientations only, which are exact.
#include "geometry/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/point_triangle.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
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

namespace {

constexpr PointPair kNoPoints{kInfinity, {}, {}};

void offer(PointPair& best, const Vec3& point1, const Vec3& point2) {
  const double squared = squared_norm(point2 - point1);
  if (squared < best.squared) best = {squared, point1, point2};
}

// The points where the lines of two segments are closest, if both lie within the segments. Uses cross
// products: products of dot products cancel completely where the segments are nearly parallel.
void offer_crossing(PointPair& best, const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& v) {
  const Vec3 n = cross(u, v), r = q - p;
  const double inverse = TriangleSides::inverse(squared_norm(n));
  const double s = dot(cross(r, v), n) * inverse, t = dot(cross(r, u), n) * inverse;
  if (s > 0 && s < 1 && t > 0 && t < 1) offer(best, p + s * u, q + t * v);
}

bool has(unsigned bits, int i) {
  return (bits >> i & 1) != 0;
}

template <class Sides>
PointPair closest(const Sides& a, const Sides& b, const Features& of_a, const Features& of_b) {
  PointPair best = kNoPoints;
  for (int i = 0; i < 3; ++i) {
    if (!has(of_a.corners | of_a.sides | of_b.corners, i)) continue;
    const Vec3 &p = a.corner[i], &q = b.corner[i];
    Vec3 foot;
    for (int j = 0; j < 3; ++j) {
      if (has(of_a.corners, i) && has(of_b.sides, j)) offer(best, p, b.on_side(j, p));
      if (has(of_b.corners, i) && has(of_a.sides, j)) offer(best, a.on_side(j, q), q);
      if (has(of_a.sides, i) && has(of_b.sides, j))
        offer_crossing(best, p, a.side[i], b.corner[j], b.side[j]);
    }
    if (has(of_a.corners, i) && b.over(p, foot)) offer(best, p, foot);
    if (has(of_b.corners, i) && a.over(q, foot)) offer(best, foot, q);
  }
  return best;
}

PointPair closest(const TriangleSides& a, const TriangleSides& b) {
  constexpr Features kAll{.corners = 7, .sides = 7};
  return closest(a, b, kAll, kAll);
}

double largest_coordinate(const Corners& a, const Corners& b) {
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(a[i][k]), std::abs(b[i][k])});
  return largest;
}

// Whether all points of closest() are certainly farther apart than `distance`: no corner is as near to the
// plane of the other triangle, and no two lines of sides are as near to each other.
bool farther_apart(const TriangleSides& a, const TriangleSides& b, double distance) {
  // Points and differences have rounding errors of some units in the last place of the largest coordinate,
  // normals of its square, and products with them of its cube.
  const double most = largest_coordinate(a.corner, b.corner);
  const double apart = distance + kDoubleRounding * most, rounding = kDoubleRounding * most * most * most;
  const auto beyond = [&](const Vec3& between, const Vec3& normal) {
    const double height = std::abs(dot(between, normal)) - rounding;
    return height > 0 && height * height > apart * apart * squared_norm(normal);
  };
  for (const Vec3& p : a.corner)
    if (!beyond(p - b.corner[0], b.normal)) return false;
  for (const Vec3& p : b.corner)
    if (!beyond(p - a.corner[0], a.normal)) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!beyond(b.corner[j] - a.corner[i], cross(a.side[i], b.side[j]))) return false;
  return true;
}

Box box_of(const Corners& triangle) {
  Box box;
  for (int k = 0; k < 3; ++k)
    std::tie(box.lower[k], box.upper[k]) = std::minmax({triangle[0][k], triangle[1][k], triangle[2][k]});
  return box;
}

}  // namespace

double squared_box_distance(const Corners& a, const Corners& b) {
  return squared_norm(gap(box_of(a), box_of(b)));
}

PointPair closest_points(const Corners& a, const Corners& b) {
  return closest(TriangleSides(a), TriangleSides(b));
}

PointPair closest_points(const Corners& a, const Features& of_a, const Corners& b, const Features& of_b) {
  return closest(FewSides(a), FewSides(b), of_a, of_b);
}

Vec3 common_point(const Corners& a, const Corners& b) {
  // An edge and the interior of the triangle that it crosses, or a corner and the other triangle, or two
  // edges. The first of those that are nearest counts, in the order of closest() and then of edges.
  const TriangleSides sides[2] = {TriangleSides(a), TriangleSides(b)};
  PointPair crossing = kNoPoints;
  for (int i = 0; i < 2; ++i) {
    const TriangleSides &edges = sides[i], &face = sides[1 - i];
    for (int k = 0; k < 3; ++k) {
      const double along = dot(edges.side[k], face.normal);
      const double t = dot(face.corner[0] - edges.corner[k], face.normal) / along;
      if (!(t >= 0 && t <= 1)) continue;
      const Vec3 point = edges.corner[k] + t * edges.side[k];
      Vec3 foot;
      if (face.over(point, foot)) offer(crossing, point, foot);
    }
  }
  if (farther_apart(sides[0], sides[1], std::sqrt(crossing.squared))) return crossing.point1;
  const PointPair best = closest(sides[0], sides[1]);
  return crossing.squared < best.squared ? crossing.point1 : best.point1;
}

PointPair closest_or_common(const Corners& a, const Corners& b) {
  if (squared_box_distance(a, b) > 0 || !triangles_intersect(a, b)) return closest_points(a, b);
  const Vec3 point = common_point(a, b);
  return {0, point, point};
}

}  // namespace sdm::core

// Closest points of triangles: the minimum over all pairs of features. The points lie on the features
// regardless of rounding.
#include "geometry/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "geometry/point_triangle.h"
#include "geometry/rounding.h"

namespace sdm::core {
namespace {

constexpr PointPair kNoPoints{std::numeric_limits<double>::infinity(), {}, {}};

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
    std::tie(box.lo[k], box.hi[k]) = std::minmax({triangle[0][k], triangle[1][k], triangle[2][k]});
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

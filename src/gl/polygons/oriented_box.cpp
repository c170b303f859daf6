#include "gl/polygons/oriented_box.h"

#include <algorithm>
#include <cmath>

namespace sdm::gl {
namespace {

// Any unit vector orthogonal to `axis`, which has length 1.
Vec3 across(const Vec3& axis) {
  const int least =
      static_cast<int>(std::min_element(axis.begin(), axis.end(),
                                        [](double a, double b) { return std::abs(a) < std::abs(b); }) -
                       axis.begin());
  Vec3 unit{};
  unit[least] = 1;
  return normalized(cross(axis, unit));
}

// A box given by its axes and its interval along each of them, relative to `origin`.
OrientedBox from_intervals(const Vec3& origin, const std::array<Vec3, 3>& axes, const Vec3& lo,
                           const Vec3& hi, double slack) {
  OrientedBox box{origin, axes, {}};
  for (int k = 0; k < 3; ++k) {
    box.centre += 0.5 * (lo[k] + hi[k]) * axes[k];
    box.half[k] = 0.5 * (hi[k] - lo[k]) + slack;
  }
  return box;
}

OrientedBox cube(const Vec3& centre, double half) {
  return {centre, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {half, half, half}};
}

// The prism over the face: its bounding rectangle along the longest side, extended to both sides of the
// plane.
OrientedBox around_face(const SiteRegion& region, double reach, double slack) {
  Vec3 longest{};
  for (int k = 0; k < 3; ++k)
    if (const Vec3 side = region.corners[(k + 1) % 3] - region.corners[k];
        squared_norm(side) > squared_norm(longest))
      longest = side;
  const Vec3 along = normalized(longest - dot(longest, region.axis) * region.axis);
  const std::array<Vec3, 3> axes{along, normalized(cross(region.axis, along)), normalized(region.axis)};
  Vec3 lo{0, 0, -reach}, hi{0, 0, reach};
  for (int k = 0; k < 2; ++k)
    for (const Vec3& corner : region.corners) {
      const double t = dot(axes[k], corner - region.anchor);
      lo[k] = std::min(lo[k], t);
      hi[k] = std::max(hi[k], t);
    }
  return from_intervals(region.anchor, axes, lo, hi, slack);
}

// The wedge where y·n ≥ 0 for one or two normals: symmetric about b = Σ n. The sine of the angle between b
// and a ray that bounds the wedge is n·b, so the wedge, truncated at `reach`, covers [0, reach] along b and ±
// reach n·b across it.
OrientedBox around_edge(const SiteRegion& region, double reach, double slack) {
  const Vec3 along = normalized(region.axis);
  if (along == Vec3{}) return cube(region.anchor, reach + slack);
  std::array<Vec3, 2> normals{};  // orthogonal to the edge, of length 1 in double: their sum may be nearly 0
  const int count = region.wall_count - region.strict_walls;
  for (int k = 0; k < count; ++k) {
    const Vec3& n = region.walls[region.strict_walls + k].normal;
    normals[k] = normalized(n - dot(n, along) * along);
  }
  const Vec3 sum = normals[0] + normals[1];
  const bool wedge = norm(sum) > 1e-6;
  const Vec3 middle = wedge ? normalized(sum) : across(along);
  const double sine = wedge ? std::max(dot(normals[0], middle), dot(normals[1], middle)) : 1;
  const double length = norm(region.corners[1] - region.corners[0]);
  return from_intervals(region.anchor, {along, middle, cross(along, middle)},
                        {0, wedge ? 0 : -reach, -sine * reach}, {length, reach, sine * reach}, slack);
}

// The unit vectors along the edges of the cone where y·n ≥ 0 for every wall: each is orthogonal to two
// normals.
struct ConeEdges {
  std::array<Vec3, 12> rays;  // both directions for each pair of four walls
  int count = 0;
  bool degenerate = false;  // two normals determine no orthogonal direction

  explicit ConeEdges(const SiteRegion& region) {
    for (int i = 0; i < region.wall_count; ++i)
      for (int j = 0; j < region.wall_count; ++j) {
        if (i == j) continue;
        const Vec3 ray = normalized(cross(region.walls[i].normal, region.walls[j].normal));
        degenerate |= ray == Vec3{};
        bool inside = true;
        for (int k = 0; k < region.wall_count; ++k) inside &= dot(region.walls[k].normal, ray) >= -1e-6;
        if (inside) rays[count++] = ray;
      }
  }
};

// Around b, the middle of the cone's edges e, if e·b > 0 for all of them: a unit vector y = Σ λ e of the cone
// has y·b ≥ 0 and Σ λ ≤ 1 / min(e·b), so y·t ≤ max(e·t) / min(e·b) along any t.
OrientedBox around_vertex(const SiteRegion& region, double reach, double slack) {
  const ConeEdges edges(region);
  Vec3 sum{};
  for (int i = 0; i < edges.count; ++i) sum += edges.rays[i];
  const Vec3 middle = normalized(sum);
  double least = 1;
  for (int i = 0; i < edges.count; ++i) least = std::min(least, dot(edges.rays[i], middle));
  // The cone of a saddle is the vertex alone. A degenerate cone, or one that nearly fills a half-space, gets
  // no tighter box.
  if (edges.count == 0 && region.wall_count == sites::VertexRegion::kRays && !edges.degenerate)
    return cube(region.anchor, slack);
  if (edges.count < 3 || edges.degenerate || least < 0.01) return cube(region.anchor, reach + slack);

  const Vec3 side = across(middle), other = cross(middle, side);
  Vec3 lo{}, hi{0, 0, reach};
  for (int i = 0; i < edges.count; ++i) {
    const double s = dot(edges.rays[i], side), t = dot(edges.rays[i], other);
    lo[0] = std::min(lo[0], s);
    hi[0] = std::max(hi[0], s);
    lo[1] = std::min(lo[1], t);
    hi[1] = std::max(hi[1], t);
  }
  for (int k = 0; k < 2; ++k) {
    lo[k] = reach * std::max(lo[k] / least, -1.0);
    hi[k] = reach * std::min(hi[k] / least, 1.0);
  }
  return from_intervals(region.anchor, {side, other, middle}, lo, hi, slack);
}

}  // namespace

OrientedBox oriented_box(const SiteRegion& region, double reach, double slack) {
  switch (region.type) {
    case SiteType::face:
      return around_face(region, reach, slack);
    case SiteType::edge:
      return around_edge(region, reach, slack);
    default:
      return around_vertex(region, reach, slack);
  }
}

bool may_meet(const OrientedBox& box, const tree::FloatBox& other) {
  Vec3 centre, half;
  for (int k = 0; k < 3; ++k) {
    centre[k] = 0.5 * (double{other.lower[k]} + other.upper[k]);
    half[k] = 0.5 * (double{other.upper[k]} - other.lower[k]);
  }
  const Vec3 between = centre - box.centre;
  for (int k = 0; k < 3; ++k) {
    const Vec3& axis = box.axes[k];
    const double radius =
        std::abs(axis[0]) * half[0] + std::abs(axis[1]) * half[1] + std::abs(axis[2]) * half[2];
    if (std::abs(dot(axis, between)) > box.half[k] + radius) return false;
  }
  for (int i = 0; i < 3; ++i) {
    double radius = half[i];
    for (int k = 0; k < 3; ++k) radius += std::abs(box.axes[k][i]) * box.half[k];
    if (std::abs(between[i]) > radius) return false;
  }
  return true;
}

}  // namespace sdm::gl

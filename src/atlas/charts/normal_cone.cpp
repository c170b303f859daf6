#include "atlas/charts/normal_cone.h"

#include <algorithm>

#include "atlas/charts/tangent_frame.h"

namespace sdm::atlas {
namespace {

struct Cap {
  Vec3 axis;
  double cos;  ///< the smallest ray·axis
};

// Gnomonic projection about the axis maps convex cones to convex sets: the extreme rays are the corners of
// the hull.
std::vector<Vec3> extreme_rays(std::span<const Vec3> vectors, const Vec3& axis) {
  struct Point {
    Vec2 at;
    Vec3 ray;
    auto operator<=>(const Point&) const = default;
  };
  const auto [right, up] = tangent_frame(axis);
  std::vector<Point> points;
  points.reserve(vectors.size());
  for (const Vec3& v : vectors) {
    const double depth = dot(v, axis);
    points.push_back({{dot(v, right) / depth, dot(v, up) / depth}, v});
  }
  const auto hull = convex_hull(std::move(points), [](const Point& p) -> const Vec2& { return p.at; });
  std::vector<Vec3> rays;
  rays.reserve(hull.size());
  for (const Point& p : hull) rays.push_back(p.ray);
  return rays;
}

// The centre of the smallest cap is the direction of the centre of the smallest ball around the unit vectors,
// which steps of 1/(i + 1) towards the farthest one approach (Bădoiu & Clarkson 2003). Stops early at a cap
// within cos_angle.
Cap find_cap(std::span<const Vec3> rays, Vec3 centre, double cos_angle) {
  constexpr int kSteps = 24;
  Cap best{{}, -1};
  for (int i = 1; i <= kSteps && best.cos < cos_angle; ++i) {
    const Vec3 axis = normalized(centre);
    const Vec3* farthest = &rays[0];
    double least = dot(rays[0], axis);
    for (const Vec3& ray : rays)
      if (const double cos = dot(ray, axis); cos < least) {
        least = cos;
        farthest = &ray;
      }
    if (least > best.cos) best = {axis, least};
    centre += (1.0 / (i + 1)) * (*farthest - centre);
  }
  return best;
}

const Vec3& farthest(std::span<const Vec3> rays, const Vec3& direction) {
  return *std::min_element(rays.begin(), rays.end(), [&](const Vec3& a, const Vec3& b) {
    return dot(a, direction) < dot(b, direction);
  });
}

}  // namespace

NormalCone spanned_cone(std::span<const Vec3> normals, const Vec3& axis) {
  NormalCone cone;
  cone.rays = extreme_rays(normals, axis);
  cone.axis = find_cap(cone.rays, axis, 1).axis;
  return cone;
}

std::optional<NormalCone> join(const NormalCone& a, const NormalCone& b, double cos_angle) {
  // Two rays more than 2θ apart fit no cap of angle θ: comparing the extremes rejects most pairs that do not
  // fit.
  const Vec3& from_b = farthest(a.rays, b.axis);
  if (dot(from_b, farthest(b.rays, from_b)) < 2 * cos_angle * cos_angle - 1) return std::nullopt;
  std::vector<Vec3> rays = a.rays;
  rays.insert(rays.end(), b.rays.begin(), b.rays.end());
  const Cap cap = find_cap(rays, normalized(a.axis + b.axis), cos_angle);
  if (cap.cos < cos_angle) return std::nullopt;
  return NormalCone{cap.axis, extreme_rays(rays, cap.axis)};
}

}  // namespace sdm::atlas

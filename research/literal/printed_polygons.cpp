#include "research/literal/printed_polygons.h"

#include <algorithm>
#include <cmath>

#include "research/site_code.h"

namespace sdm::literal {
namespace {

using gl::ConvexPolygon;
using gl::HalfPlane;
using gl::HalfSpace;
using gl::OrientedBox;
using gl::PlanarDomain;
using gl::SiteRegion;

std::array<HalfSpace, 6> sides(const OrientedBox& box) {
  std::array<HalfSpace, 6> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const double middle = dot(box.axes[k], box.centre);
    result[2 * k] = {box.axes[k], middle - box.half[k]};
    result[2 * k + 1] = {-box.axes[k], -middle - box.half[k]};
  }
  return result;
}

// A rectangle that contains the part of the domain's plane inside the box; empty if that is far from the
// image. The map of the plane into the image is x -> G^-1 J^T x, with the edges of a texel as the columns of
// J, and G = J^T J.
ConvexPolygon plane_around(const OrientedBox& box, const PlanarDomain& domain) {
  constexpr double kFar = 1 << 20;  // texels
  const auto& [a, b] = domain.edges;
  const double aa = squared_norm(a), bb = squared_norm(b), ab = dot(a, b), det = aa * bb - ab * ab;
  const double least =
      2 * det / (aa + bb + std::sqrt((aa - bb) * (aa - bb) + 4 * ab * ab));  // eigenvalue of G
  if (!(least > 0)) return domain.outline;
  const Vec3 d = box.centre - domain.origin;
  const Vec2 middle = domain.image_origin +
                      Vec2{(bb * dot(a, d) - ab * dot(b, d)) / det, (aa * dot(b, d) - ab * dot(a, d)) / det};
  const double radius = norm(box.half) / std::sqrt(least) + 1;
  Vec2 lower, upper;
  for (int k = 0; k < 2; ++k) {
    lower[k] = std::max(middle[k] - radius, -kFar);
    upper[k] = std::min(middle[k] + radius, kFar);
    if (!(lower[k] < upper[k])) return {};
  }
  return ConvexPolygon::rectangle(lower, upper);
}

}  // namespace

void PrintedBatch::append(const PrintedBatch& other) {
  RasterBatch::append(other);
  corner_vectors.insert(corner_vectors.end(), other.corner_vectors.begin(), other.corner_vectors.end());
}

bool PrintedPolygons::cut(ConvexPolygon& polygon, HalfPlane wall) const {
  if (corrections.margins)
    wall.value += rules.slack + gl::kMargin * std::sqrt(dot(wall.gradient, wall.gradient));
  polygon.cut(wall);
  return !polygon.empty();
}

// Line 8. Returns false if nothing remains.
bool PrintedPolygons::clip(ConvexPolygon& polygon, const SiteRegion& region, const OrientedBox& box,
                           const PlanarDomain& domain) const {
  if (corrections.region_walls) {
    for (int k = 0; k < region.wall_count; ++k)
      if (!cut(polygon, restrict(region.walls[k], domain))) return false;
  } else {
    for (const HalfSpace& side : sides(box))
      if (!cut(polygon, restrict(side, domain))) return false;
  }
  return true;
}

bool PrintedPolygons::add(PrintedBatch& batch, const SiteRegion& region, const OrientedBox& box,
                          const PlanarDomain& domain) const {
  ConvexPolygon polygon = corrections.tiles ? domain.outline : plane_around(box, domain);
  if (!clip(polygon, region, box, domain)) return false;
  const std::span<const Vec2> corners = polygon.corners();
  gl::RasterPolygon& p = append_polygon(batch, corners, region, domain, rules.to_depth);
  if (!corrections.confirmation) p.winner = research::site_code(region.type, region.site);
  if (!corrections.fragment_vectors)
    for (const Vec2& c : corners) {
      const Vec3 x = domain.point(c);
      const Vec3 vector = corrections.affine_vectors ? region.distance_vector(x) : region.vector_to_site(x);
      auto& stored = batch.corner_vectors.emplace_back();
      for (int k = 0; k < 3; ++k) stored[k] = static_cast<float>(rules.to_depth * vector[k]);
    }
  if (corrections.region_walls && corrections.margins)  // fragments decide
    for (int k = 0; k < region.strict_walls; ++k)
      set_wall(p, k, restrict(region.walls[k], domain), gl::base_point(corners), rules);
  return true;
}

}  // namespace sdm::literal

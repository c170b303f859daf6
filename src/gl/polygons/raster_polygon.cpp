#include "gl/polygons/raster_polygon.h"

#include <algorithm>
#include <cmath>

namespace sdm::gl {
namespace {

// The wall restricted to the domain's plane.
HalfPlane restrict(const HalfSpace& wall, const PlanarDomain& domain) {
  HalfPlane h;
  h.gradient = {dot(wall.normal, domain.edges[0]), dot(wall.normal, domain.edges[1])};
  h.value = dot(wall.normal, domain.origin) - wall.offset - dot(h.gradient, domain.image_origin);
  return h;
}

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
  Vec2 lo, hi;
  for (int k = 0; k < 2; ++k) {
    lo[k] = std::max(middle[k] - radius, -kFar);
    hi[k] = std::min(middle[k] + radius, kFar);
    if (!(lo[k] < hi[k])) return {};
  }
  return ConvexPolygon::rectangle(lo, hi);
}

void store(float (&out)[3], const Vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

}  // namespace

void RasterBatch::append(const RasterBatch& other) {
  const auto polygon = static_cast<std::uint32_t>(polygons.size());
  const auto corner = static_cast<std::uint32_t>(corners.size());
  polygons.insert(polygons.end(), other.polygons.begin(), other.polygons.end());
  for (const RasterCorner& c : other.corners) corners.push_back({c.u, c.v, c.polygon + polygon});
  for (std::size_t i = 1; i < other.first_corner.size(); ++i)
    first_corner.push_back(other.first_corner[i] + corner);
  corner_vectors.insert(corner_vectors.end(), other.corner_vectors.begin(), other.corner_vectors.end());
}

bool add_polygon(RasterBatch& batch, const SiteRegion& region, const OrientedBox& box,
                 const PlanarDomain& domain, const RasterRules& rules) {
  const Corrections& corrections = rules.corrections;
  ConvexPolygon polygon = corrections.tiles ? domain.outline : plane_around(box, domain);
  const auto cut = [&](HalfPlane wall) {
    if (corrections.margins)
      wall.value += rules.slack + kMargin * std::sqrt(dot(wall.gradient, wall.gradient));
    polygon.cut(wall);
    return !polygon.empty();
  };
  std::array<HalfPlane, SiteRegion::kMostWalls> walls;
  for (int k = 0; k < region.wall_count; ++k) {
    walls[k] = restrict(region.walls[k], domain);
    if (corrections.region_walls && !cut(walls[k])) return false;
  }
  if (!corrections.region_walls)
    for (const HalfSpace& side : sides(box))
      if (!cut(restrict(side, domain))) return false;

  const std::span<const Vec2> corners = polygon.corners();
  const auto index = static_cast<std::uint32_t>(batch.polygons.size());
  for (const Vec2& c : corners)
    batch.corners.push_back({static_cast<float>(c[0]), static_cast<float>(c[1]), index});
  batch.first_corner.push_back(static_cast<std::uint32_t>(batch.corners.size()));
  if (!corrections.fragment_vectors)
    for (const Vec2& c : corners) {
      const Vec3 x = domain.point(c);
      const Vec3 vector = corrections.affine_vectors ? region.distance_vector(x) : region.vector_to_site(x);
      auto& stored = batch.corner_vectors.emplace_back();
      for (int k = 0; k < 3; ++k) stored[k] = static_cast<float>(rules.to_depth * vector[k]);
    }

  RasterPolygon& p = batch.polygons.emplace_back();
  const Vec2 origin{std::floor(corners[0][0]) + 0.5, std::floor(corners[0][1]) + 0.5};
  p.origin_u = static_cast<float>(origin[0]);
  p.origin_v = static_cast<float>(origin[1]);
  store(p.vector, rules.to_depth * region.distance_vector(domain.point(origin)));
  store(p.vector_du, rules.to_depth * region.change(domain.edges[0]));
  store(p.vector_dv, rules.to_depth * region.change(domain.edges[1]));
  p.winner = corrections.confirmation ? region.face : site_code(region.type, region.site);
  p.domain = domain.id;
  const bool fragments_decide = corrections.region_walls && corrections.margins;
  for (int k = 0; k < SiteRegion::kMostWalls; ++k) {
    if (k >= region.strict_walls || !fragments_decide) {
      store(p.walls[k], {1, 0, 0});
      continue;
    }
    const HalfPlane& w = walls[k];
    store(p.walls[k], rules.to_depth * Vec3{w(origin) + rules.slack, w.gradient[0], w.gradient[1]});
  }
  return true;
}

}  // namespace sdm::gl

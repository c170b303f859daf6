#include "engine/gl/raster_polygon.h"

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
}

bool add_polygon(RasterBatch& batch, const SiteRegion& region, const PlanarDomain& domain,
                 const RasterScale& scale) {
  std::array<HalfPlane, SiteRegion::kMostWalls> walls;
  ConvexPolygon polygon = domain.outline;
  for (int k = 0; k < region.wall_count; ++k) {
    walls[k] = restrict(region.walls[k], domain);
    HalfPlane loose = walls[k];
    loose.value += scale.slack + kMargin * std::sqrt(dot(loose.gradient, loose.gradient));
    polygon.cut(loose);
    if (polygon.empty()) return false;
  }

  const std::span<const Vec2> corners = polygon.corners();
  const auto index = static_cast<std::uint32_t>(batch.polygons.size());
  for (const Vec2& c : corners)
    batch.corners.push_back({static_cast<float>(c[0]), static_cast<float>(c[1]), index});
  batch.first_corner.push_back(static_cast<std::uint32_t>(batch.corners.size()));

  RasterPolygon& p = batch.polygons.emplace_back();
  const Vec2 origin{std::floor(corners[0][0]) + 0.5, std::floor(corners[0][1]) + 0.5};
  p.origin_u = static_cast<float>(origin[0]);
  p.origin_v = static_cast<float>(origin[1]);
  store(p.vector, scale.to_depth * region.distance_vector(domain.point(origin)));
  store(p.vector_du, scale.to_depth * region.change(domain.edges[0]));
  store(p.vector_dv, scale.to_depth * region.change(domain.edges[1]));
  p.face = region.face;
  p.domain = domain.id;
  for (int k = 0; k < SiteRegion::kMostWalls; ++k) {
    if (k >= region.strict_walls) {
      store(p.walls[k], {1, 0, 0});
      continue;
    }
    const HalfPlane& w = walls[k];
    store(p.walls[k], scale.to_depth * Vec3{w(origin) + scale.slack, w.gradient[0], w.gradient[1]});
  }
  return true;
}

}  // namespace sdm::gl

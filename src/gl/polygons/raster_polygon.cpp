#include "gl/polygons/raster_polygon.h"

#include <cmath>

namespace sdm::gl {
namespace {

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

HalfPlane restrict(const HalfSpace& wall, const PlanarDomain& domain) {
  HalfPlane h;
  h.gradient = {dot(wall.normal, domain.edges[0]), dot(wall.normal, domain.edges[1])};
  h.value = dot(wall.normal, domain.origin) - wall.offset - dot(h.gradient, domain.image_origin);
  return h;
}

Vec2 base_point(std::span<const Vec2> corners) {
  return {std::floor(corners[0][0]) + 0.5, std::floor(corners[0][1]) + 0.5};
}

RasterPolygon& append_polygon(RasterBatch& batch, std::span<const Vec2> corners, const SiteRegion& region,
                              const PlanarDomain& domain, double to_depth) {
  const auto index = static_cast<std::uint32_t>(batch.polygons.size());
  for (const Vec2& c : corners)
    batch.corners.push_back({static_cast<float>(c[0]), static_cast<float>(c[1]), index});
  batch.first_corner.push_back(static_cast<std::uint32_t>(batch.corners.size()));

  RasterPolygon& p = batch.polygons.emplace_back();
  const Vec2 base = base_point(corners);
  p.origin_u = static_cast<float>(base[0]);
  p.origin_v = static_cast<float>(base[1]);
  store(p.vector, to_depth * region.distance_vector(domain.point(base)));
  store(p.vector_du, to_depth * region.change(domain.edges[0]));
  store(p.vector_dv, to_depth * region.change(domain.edges[1]));
  p.winner = region.face;
  p.domain = domain.id;
  for (auto& wall : p.walls) store(wall, {1, 0, 0});
  return p;
}

void set_wall(RasterPolygon& polygon, int k, const HalfPlane& wall, const Vec2& base,
              const RasterRules& rules) {
  store(polygon.walls[k],
        rules.to_depth * Vec3{wall(base) + rules.slack, wall.gradient[0], wall.gradient[1]});
}

bool add_polygon(RasterBatch& batch, const SiteRegion& region, const PlanarDomain& domain,
                 const RasterRules& rules) {
  ConvexPolygon polygon = domain.outline;
  std::array<HalfPlane, SiteRegion::kMostWalls> walls;
  for (int k = 0; k < region.wall_count; ++k) {
    HalfPlane wall = walls[k] = restrict(region.walls[k], domain);
    wall.value += rules.slack + kMargin * std::sqrt(dot(wall.gradient, wall.gradient));
    polygon.cut(wall);
    if (polygon.empty()) return false;
  }
  RasterPolygon& p = append_polygon(batch, polygon.corners(), region, domain, rules.to_depth);
  const Vec2 base = base_point(polygon.corners());
  for (int k = 0; k < region.strict_walls; ++k) set_wall(p, k, walls[k], base, rules);
  return true;
}

}  // namespace sdm::gl

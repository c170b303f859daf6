#include "map/transfer/closest_of_texels.h"

#include <sdm/closest_points.h>

#include <algorithm>

#include "geometry/triangle.h"
#include "sites/closest_on_face.h"

namespace sdm::map {

ClosestOfTexels::ClosestOfTexels(const Surface& surface, const Sites& sites, const DistanceMap& map)
    : surface_(internals(surface)), sites_(sites), data_(internals(sites)), map_(map) {}

SurfacePoint ClosestOfTexels::at(std::uint32_t texel) {
  const SiteType type = map_.site_type[texel];
  if (type == SiteType::none) return {};
  const Vec3 point = surface_.texel_point(surface_.texel_faces[texel], texel);
  const std::uint32_t site = map_.site[texel];
  const bool ends_elsewhere =
      map_.measured.kind != DistanceKind::closest && map_.measured.kind != DistanceKind::facing;
  if (ends_elsewhere) return end_of_vector(texel, point);
  if (SurfacePoint found; type == SiteType::face && in_face(site, point, found)) return found;
  return map_.measured.kind == DistanceKind::closest ? point_on_face(sites_, type, site, point)
                                                     : on_site(type, site, point);
}

bool ClosestOfTexels::in_face(std::uint32_t face, const Vec3& query, SurfacePoint& found) {
  if (face >= data_.mesh.triangles.size() || data_.sliver[face] != 0) return false;
  if (face != face_) face_ = face, frame_ = BarycentricFrame(corners_of(data_.mesh, face));
  // The coordinates of a point beside the face are limited to its sides, where one is 0.
  constexpr double kBesideSides = 1e-9;
  found = {face, frame_.weights(query)};
  return *std::ranges::min_element(found.barycentric) > kBesideSides;
}

SurfacePoint ClosestOfTexels::end_of_vector(std::uint32_t texel, const Vec3& point) const {
  const std::uint32_t face = map_.site[texel];
  const auto [p, q, r] = corners_of(data_.mesh, face);
  Vec3 end = point;
  for (int i = 0; i < 3; ++i) end[i] += map_.vector[texel][i];
  return {face, barycentric(p, q, r, end)};
}

SurfacePoint ClosestOfTexels::on_site(SiteType type, std::uint32_t site, const Vec3& query) const {
  const ClosestPoint c = sites::closest_around_site(data_, type, site, query);
  const auto [p, q, r] = corners_of(data_.mesh, c.face);
  return {c.face, barycentric(p, q, r, c.point)};
}

}  // namespace sdm::map

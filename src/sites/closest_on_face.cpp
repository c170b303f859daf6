#include "sites/closest_on_face.h"

#include <algorithm>
#include <cmath>

#include "geometry/point_triangle.h"

namespace sdm::sites {
namespace {

// Whether the direction from c to q points into any of the faces around the site: then that face is strictly
// closer.
bool improve(const SitesData& sites, std::span<const std::uint32_t> faces, const Vec3& q, ClosestPoint& c) {
  const Vec3 to_query = q - c.point;
  for (std::uint32_t face : faces) {
    if (face == c.face) continue;
    const Triangle& t = sites.mesh.triangles[face];
    const bool ascends = std::any_of(t.begin(), t.end(), [&](std::uint32_t v) {
      return dot(to_query, sites.mesh.positions[v] - c.point) > 0;
    });
    if (!ascends) continue;
    if (const ClosestPoint other = closest_on_face(sites, face, q); other.distance < c.distance) {
      c = other;
      return true;
    }
  }
  return false;
}

}  // namespace

ClosestPoint closest_on_face(const SitesData& sites, std::uint32_t face, const Vec3& q) {
  // A sliver is too thin for a reliable normal.
  const ClosestFeature closest =
      closest_feature(q, corners_of(sites.mesh, face), /*flat=*/sites.sliver[face] == 0);
  ClosestPoint c{.point = closest.point, .distance = std::sqrt(closest.squared), .face = face};
  switch (closest.feature) {
    case TriangleFeature::corner:
      c.type = SiteType::vertex;
      c.site = sites.mesh.triangles[face][closest.index];
      break;
    case TriangleFeature::side:
      c.type = SiteType::edge;
      c.site = sites.topology.face_edges[face][closest.index];
      break;
    case TriangleFeature::interior:
      c.type = SiteType::face;
      c.site = face;
  }
  return c;
}

ClosestPoint closest_around_face(const SitesData& sites, std::uint32_t face, const Vec3& q) {
  ClosestPoint c = closest_on_face(sites, face, q);
  for (bool improved = true; improved && c.type != SiteType::face;) {
    const std::span<const std::uint32_t> faces =
        c.type == SiteType::edge ? sites.topology.edge_faces(c.site) : sites.vertex_faces.of(c.site);
    improved = improve(sites, faces, q, c);
  }
  return c;
}

ClosestPoint closest_around_site(const SitesData& sites, SiteType type, std::uint32_t site, const Vec3& q) {
  if (type != SiteType::face)
    for (const std::uint32_t face :
         type == SiteType::edge ? sites.topology.edge_faces(site) : sites.vertex_faces.of(site))
      if (const ClosestPoint c = closest_on_face(sites, face, q); c.type == type && c.site == site) return c;
  return closest_on_face(sites, sites.face_of(type, site), q);
}

}  // namespace sdm::sites

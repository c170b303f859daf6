#include "engine/closest_on_face.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace sdm {
namespace {

ClosestPoint at(const Vec3& point, const Vec3& q, SiteType type, std::uint32_t site, std::uint32_t face) {
  return {.point = point, .distance = norm(point - q), .site = site, .type = type, .face = face};
}

// Over the face's prism the closest point is the foot of the perpendicular. Returns whether q is there.
bool foot_in_face(const std::array<Vec3, 3>& corner, const Vec3& q, Vec3& foot) {
  const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double squared = squared_norm(normal);
  if (!(squared > 0)) return false;
  for (int k = 0; k < 3; ++k)
    if (!(dot(q - corner[k], cross(normal, corner[(k + 1) % 3] - corner[k])) > 0)) return false;
  foot = q - (dot(q - corner[0], normal) / squared) * normal;
  return true;
}

// Whether the direction from c to q points into any of the faces around the site: then that face is strictly
// closer.
bool improve(const Sites::Impl& sites, std::span<const std::uint32_t> faces, const Vec3& q, ClosestPoint& c) {
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

ClosestPoint closest_on_face(const Sites::Impl& sites, std::uint32_t face, const Vec3& q) {
  const Triangle& t = sites.mesh.triangles[face];
  const auto& p = sites.mesh.positions;
  const std::array<Vec3, 3> corner{p[t[0]], p[t[1]], p[t[2]]};
  if (Vec3 foot; foot_in_face(corner, q, foot)) return at(foot, q, SiteType::face, face, face);

  ClosestPoint best;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec3 along = corner[next] - corner[k];
    const double projection = dot(q - corner[k], along), length = squared_norm(along);
    const ClosestPoint candidate = projection <= 0 ? at(corner[k], q, SiteType::vertex, t[k], face)
                                   : projection >= length
                                       ? at(corner[next], q, SiteType::vertex, t[next], face)
                                       : at(corner[k] + (projection / length) * along, q, SiteType::edge,
                                            sites.topology.face_edges[face][k], face);
    if (candidate.distance < best.distance) best = candidate;
  }
  return best;
}

ClosestPoint closest_around_face(const Sites::Impl& sites, std::uint32_t face, const Vec3& q) {
  ClosestPoint c = closest_on_face(sites, face, q);
  for (bool improved = true; improved && c.type != SiteType::face;) {
    const VertexFaces& around = sites.vertex_faces;
    const std::span<const std::uint32_t> faces =
        c.type == SiteType::edge
            ? sites.topology.edge_faces(c.site)
            : std::span(around.faces)
                  .subspan(around.offsets[c.site], around.offsets[c.site + 1] - around.offsets[c.site]);
    improved = improve(sites, faces, q, c);
  }
  return c;
}

}  // namespace sdm

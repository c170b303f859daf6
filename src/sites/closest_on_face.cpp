#include "sites/closest_on_face.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"

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
  const Triangle& t = sites.mesh.triangles[face];
  const auto& p = sites.mesh.positions;
  const Vec3 corner[3] = {p[t[0]], p[t[1]], p[t[2]]};
  const Vec3 side[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  const Vec3 to_query[3] = {q - corner[0], q - corner[1], q - corner[2]};
  const Vec3 normal = cross(side[0], side[1]);

  ClosestPoint best{.face = face};
  double best_squared = std::numeric_limits<double>::infinity();
  // The normal of a sliver is rounding noise, which may place q over the face: its sides represent it
  // instead.
  const bool sliver = sites.sliver[face] != 0;
  bool over_face = !sliver;
  for (int k = 0; k < 3; ++k) {
    // The closest point is on a side that q lies beyond, if there is one.
    if (!sliver && dot(to_query[k], cross(normal, side[k])) > 0) continue;
    over_face = false;
    const double projection = dot(to_query[k], side[k]), length = squared_norm(side[k]);
    const int next = (k + 1) % 3;
    ClosestPoint candidate{.face = face};
    if (projection <= 0) {
      candidate.point = corner[k], candidate.type = SiteType::vertex, candidate.site = t[k];
    } else if (projection >= length) {
      candidate.point = corner[next], candidate.type = SiteType::vertex, candidate.site = t[next];
    } else {
      candidate.point = corner[k] + (projection / length) * side[k];
      candidate.type = SiteType::edge, candidate.site = sites.topology.face_edges[face][k];
    }
    if (const double squared = squared_norm(candidate.point - q); squared < best_squared)
      best = candidate, best_squared = squared;
  }
  if (over_face) {
    best.point = q - (dot(to_query[0], normal) / squared_norm(normal)) * normal;
    best.type = SiteType::face, best.site = face;
  }
  best.distance = norm(best.point - q);
  return best;
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

}  // namespace sdm::sites

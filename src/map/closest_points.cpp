#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <new>

#include "core/memory.h"
#include "geometry/barycentric.h"
#include "map/engine_of.h"
#include "mesh/validate.h"
#include "sites/closest_on_face.h"
#include "sites/sites_data.h"

namespace sdm {

std::vector<ClosestPoint> closest_points(const Sites& sites, std::span<const Vec3> points,
                                         const ClosestPointOptions& options) try {
  const std::shared_ptr<const Engine> engine = map::engine_of(options);
  mesh::validate_queries(points);
  std::vector<ClosestPoint> result(points.size());
  engine->scattered(sites, points, {options.max_distance, options.progress}, result);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("closest points");
}

SurfacePoint point_on_face(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& query) {
  if (type == SiteType::none) return {};
  const sites::SitesData& data = internals(sites);
  const std::size_t count = type == SiteType::vertex ? data.mesh.positions.size()
                            : type == SiteType::edge ? data.topology.edges.size()
                                                     : data.mesh.triangles.size();
  if (site >= count || (type == SiteType::vertex && data.vertex_faces.of(site).empty()))
    throw Error("point_on_face() needs a site of these sites");
  const std::uint32_t face = data.face_of(type, site);
  const Triangle& t = data.mesh.triangles[face];
  const auto& p = data.mesh.positions;
  return {face, barycentric(p[t[0]], p[t[1]], p[t[2]], sites::closest_on_face(data, face, query).point)};
}

}  // namespace sdm

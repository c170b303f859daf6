#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <algorithm>
#include <new>
#include <tuple>
#include <vector>

#include "closest/exact.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/barycentric.h"
#include "map/closest_measure.h"
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

namespace {

void require_numbers(const sites::SitesData& part, const PartNumbers& numbers) {
  if (numbers.vertices.size() != part.mesh.positions.size() ||
      numbers.edges.size() != part.topology.edges.size() ||
      numbers.faces.size() != part.mesh.triangles.size())
    throw Error("a part needs the number of each of its vertices, edges and faces");
  for (const auto list : {numbers.vertices, numbers.edges, numbers.faces})
    if (std::ranges::adjacent_find(list, std::greater_equal<>()) != list.end())
      throw Error("the numbers of a part's vertices, edges and faces must increase");
}

ClosestInParts in_whole(const ClosestPoint& closest, const PartNumbers& numbers, const Vec3& query) {
  const auto& of_type = closest.type == SiteType::vertex ? numbers.vertices
                        : closest.type == SiteType::edge ? numbers.edges
                                                         : numbers.faces;
  ClosestInParts result{.distance = closest.distance,
                        .vector = {},
                        .site = of_type[closest.site],
                        .face = numbers.faces[closest.face],
                        .type = closest.type};
  for (int k = 0; k < 3; ++k) result.vector[k] = closest.point[k] - query[k];
  return result;
}

auto order(const ClosestInParts& c) {
  return std::tuple(c.distance, c.type, c.site, c.face);
}

}  // namespace

void merge_closest(const Sites& part, const PartNumbers& numbers, std::span<const Vec3> queries,
                   std::span<ClosestInParts> best, const MergeClosestOptions& options) try {
  const sites::SitesData& data = internals(part);
  require_numbers(data, numbers);
  if (queries.size() != best.size()) throw Error("there must be one result for each query");
  double farthest = 0;
  for (const ClosestInParts& c : best) farthest = std::max(farthest, c.distance);
  // The cpu engine's distance, within its error, bounds the search in double precision. Four times the slack,
  // because it also has to find a site wherever there is one within the limit.
  const auto widened = [&](double distance) {
    return (1 + 4 * closest::kSlack) * distance + 4 * closest::kSlack / data.frame.scale;
  };
  const std::vector<ClosestPoint> near =
      closest_points(part, queries, {.max_distance = widened(farthest), .progress = options.progress});
  constexpr std::size_t kGrain = 1024;
  parallel_for(queries.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (near[i].type == SiteType::none) continue;
      const double limit = best[i].distance, within = widened(near[i].distance);
      ClosestPoint c = closest::exact_closest(data, queries[i], std::min(limit, within));
      if (c.type == SiteType::none && within < limit) c = closest::exact_closest(data, queries[i], limit);
      if (c.type == SiteType::none) continue;
      const ClosestInParts found = in_whole(c, numbers, queries[i]);
      if (best[i].type == SiteType::none || order(found) < order(best[i])) best[i] = found;
    }
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("closest points in parts");
}

}  // namespace sdm

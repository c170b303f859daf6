#include <sdm/closest_points.h>
#include <sdm/sign.h>
#include <sdm/vertex_distances.h>

#include <cstdint>
#include <limits>
#include <new>

#include "core/arrays/rows.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "query/facing/facing_normals.h"
#include "query/facing/facing_search.h"
#include "query/inside/open_sides.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

struct Found {
  std::vector<ClosestPoint> closest;
  std::vector<std::uint8_t> inside;
};

Found find(const Mesh& mesh, const Sites& sites, const MapOptions& options) {
  const SignMethod sign = choose_sign(sites, options).method;
  Found found{closest_points(sites, mesh.positions, options), {}};
  found.inside.resize(found.closest.size());
  if (sign != SignMethod::none) found.inside = inside_flags(sites, mesh.positions, found.closest, sign);
  return found;
}

/// Distances of vertices: of those by the normals of the faces around a vertex, the least in absolute value.
std::vector<float> facing_distances(const Mesh& mesh, const Sites& sites, MapOptions options) {
  const facing::FacingSearch search(internals(sites), *options.facing);
  const bool is_signed = choose_sign(sites, options).method != SignMethod::none;
  const std::vector<Vec3> normals = facing::facing_normals(mesh, *options.facing).normals;
  options.facing.reset();
  const std::vector<ClosestPoint> closest = closest_points(sites, mesh.positions, options);
  const auto faces_at = make_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
      if (!is_removed(mesh.triangles[f]))
        for (const std::uint32_t vertex : mesh.triangles[f]) put(vertex, f);
  });
  std::vector<float> result(closest.size(), std::numeric_limits<float>::quiet_NaN());
  constexpr std::size_t kGrain = 256;
  parallel_for(result.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      double least = std::numeric_limits<double>::infinity();
      Vec3 last{};
      for (const std::uint32_t face : faces_at.of(v)) {
        if (normals[face] == last) continue;
        last = normals[face];
        const facing::Match match = search.match(mesh.positions[v], last, options.max_distance, closest[v]);
        if (match.closest.type == SiteType::none || !(match.closest.distance < least)) continue;
        least = match.closest.distance;
        result[v] = static_cast<float>(is_signed && match.behind ? -least : least);
        if (least <= closest[v].distance) break;  // no face is closer
      }
    }
  });
  return result;
}

}  // namespace

std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites, const MapOptions& asked) try {
  MapOptions options = asked;
  if (options.engine && engine_info(*options.engine).maps_only) options.engine = nullptr;
  if (options.facing) return facing_distances(mesh, sites, options);
  const auto [closest, inside] = find(mesh, sites, options);
  std::vector<float> result(closest.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < closest.size(); ++i)
    if (closest[i].type != SiteType::none)
      result[i] = static_cast<float>(inside[i] ? -closest[i].distance : closest[i].distance);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances of vertices");
}

std::vector<std::uint8_t> boundary_vertices(const Mesh& mesh, const Sites& sites, MapOptions options) try {
  if (options.engine && engine_info(*options.engine).maps_only) options.engine = nullptr;
  const inside::BoundarySites boundary(internals(sites).topology, sites.mesh().positions.size());
  const std::vector<ClosestPoint> closest = closest_points(sites, mesh.positions, options);
  std::vector<std::uint8_t> result(closest.size());
  for (std::size_t i = 0; i < closest.size(); ++i)
    result[i] = boundary.contains(closest[i].type, closest[i].site) ? 1 : 0;
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the vertices at a boundary");
}

}  // namespace sdm

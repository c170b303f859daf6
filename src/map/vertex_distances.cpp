#include <sdm/closest_points.h>
#include <sdm/facing.h>
#include <sdm/sign.h>
#include <sdm/vertex_distances.h>

#include <cstdint>
#include <limits>
#include <new>

#include "core/memory.h"
#include "mesh/vertex_normals.h"

namespace sdm {
namespace {

struct Found {
  std::vector<ClosestPoint> closest;
  std::vector<std::uint8_t> inside;
};

Found find(const Mesh& mesh, const Sites& sites, const MapOptions& options) {
  const SignMethod sign = choose_sign(sites, options).method;
  if (options.facing) {
    FacingPoints found = closest_facing_points(sites, mesh.positions, mesh::vertex_normals(mesh), options);
    if (sign == SignMethod::none) found.behind.assign(found.behind.size(), 0);
    return {std::move(found.closest), std::move(found.behind)};
  }
  Found found{closest_points(sites, mesh.positions, options), {}};
  found.inside.resize(found.closest.size());
  if (sign != SignMethod::none) found.inside = inside_flags(sites, mesh.positions, found.closest, sign);
  return found;
}

}  // namespace

std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites, MapOptions options) try {
  if (options.engine && engine_info(*options.engine).maps_only) options.engine = nullptr;
  const auto [closest, inside] = find(mesh, sites, options);
  std::vector<float> result(closest.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < closest.size(); ++i)
    if (closest[i].type != SiteType::none)
      result[i] = static_cast<float>(inside[i] ? -closest[i].distance : closest[i].distance);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances of vertices");
}

}  // namespace sdm

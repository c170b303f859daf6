#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/sites.h>

#include <cstdint>
#include <limits>
#include <new>

#include "core/memory.h"
#include "inside/open_sides.h"
#include "map/closest_measure.h"
#include "map/facing_measure.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

struct Found {
  std::vector<ClosestPoint> closest;
  std::vector<std::uint8_t> inside;
};

Found find(const Mesh& mesh, const Sites& sites, const MapOptions& options) {
  const SignMethod sign = choose_sign(sites, options).method;
  Found found{closest_points(sites, mesh.positions, map::point_options(options)), {}};
  found.inside.resize(found.closest.size());
  if (sign != SignMethod::none) found.inside = inside_flags(sites, mesh.positions, found.closest, sign);
  return found;
}

}  // namespace

std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites, const MapOptions& asked) try {
  MapOptions options = asked;
  if (options.engine && !engine_info(*options.engine).takes_points) options.engine = nullptr;
  if (options.facing) {
    map::FacingMeasure measure(mesh, sites, options);
    measure.find_closest(sites, options, mesh.positions);
    return map::measure_vertices(mesh, measure);
  }
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
  if (options.engine && !engine_info(*options.engine).takes_points) options.engine = nullptr;
  const inside::BoundarySites boundary(internals(sites).topology, sites.mesh().positions.size());
  const std::vector<ClosestPoint> closest =
      closest_points(sites, mesh.positions, map::point_options(options));
  std::vector<std::uint8_t> result(closest.size());
  for (std::size_t i = 0; i < closest.size(); ++i)
    result[i] = boundary.contains(closest[i].type, closest[i].site) ? 1 : 0;
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the vertices at a boundary");
}

std::vector<std::uint8_t> boundary_mask(const Sites& sites, const DistanceMap& map) try {
  const inside::BoundarySites boundary(internals(sites).topology, sites.mesh().positions.size());
  std::vector<std::uint8_t> mask(map.site.size());
  for (std::size_t t = 0; t < mask.size(); ++t) {
    const SiteType type = map.site_type[t];
    const std::size_t count = type == SiteType::edge     ? boundary.edges.size()
                              : type == SiteType::vertex ? boundary.vertices.size()
                                                         : 0;
    if (count > 0 && map.site[t] >= count) throw Error("boundary_mask() needs a map to the same mesh");
    mask[t] = boundary.contains(type, map.site[t]) ? 1 : 0;
  }
  return mask;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the mask of a boundary");
}

}  // namespace sdm

#include <sdm/closest_points.h>
#include <sdm/sign.h>
#include <sdm/vertex_distances.h>

#include <cstdint>
#include <limits>
#include <new>

#include "core/memory.h"

namespace sdm {

std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites, MapOptions options) try {
  if (options.engine && engine_info(*options.engine).maps_only) options.engine = nullptr;
  const SignMethod sign = choose_sign(sites, options.sign).method;
  const std::vector<ClosestPoint> closest = closest_points(sites, mesh.positions, options);
  std::vector<std::uint8_t> inside(closest.size(), 0);
  if (sign != SignMethod::none) inside = inside_flags(sites, mesh.positions, closest, sign);
  std::vector<float> result(closest.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < closest.size(); ++i)
    if (closest[i].type != SiteType::none)
      result[i] = static_cast<float>(inside[i] ? -closest[i].distance : closest[i].distance);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the distances of vertices");
}

}  // namespace sdm

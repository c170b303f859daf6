#include <sdm/closest_points.h>
#include <sdm/error.h>

#include <cmath>
#include <new>
#include <string>

#include "core/geometry/spatial_order.h"
#include "core/memory.h"
#include "engine/blocks.h"
#include "map/engine_of.h"
#include "sites/sites_data.h"

namespace sdm {

std::vector<ClosestPoint> closest_points(const Sites& sites, std::span<const Vec3> points,
                                         const MapOptions& options) try {
  const std::shared_ptr<const Engine> engine = map::engine_of(options);
  constexpr double kMaxCoordinate = 1e37;  // as for meshes
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!(std::abs(x) <= kMaxCoordinate))
        throw Error("query point " + std::to_string(i) + " has a coordinate that is NaN or beyond 1e37");
  const std::vector<std::uint32_t> order = spatial_order(points);
  std::vector<ClosestPoint> result(points.size());
  engine::for_each_block(
      points.size(), options.progress, "closest points", [&](std::size_t begin, std::size_t end) {
        std::vector<Vec3> batch(end - begin);
        for (std::size_t i = begin; i < end; ++i) batch[i - begin] = points[order[i]];
        engine->closest_points(
            sites, batch, options.max_distance, [&](std::size_t first, const sites::ClosestPacket& closest) {
              for (std::size_t i = 0; i < closest.count; ++i) {
                ClosestPoint& c = result[order[begin + first + i]] = closest.get(i, batch[first + i]);
                if (c.type != SiteType::none) c.face = internals(sites).face_of(c.type, c.site);
              }
            });
      });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("closest points");
}

}  // namespace sdm

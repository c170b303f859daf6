#include "closest/engine.h"

#include "closest/blocks.h"
#include "closest/scattered.h"
#include "geometry/spatial_order.h"
#include "sites/sites_data.h"

namespace sdm {

const EngineInfo& engine_info(const Engine& engine) {
  return engine.info();
}

void Engine::map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
                 const engine::SampleSink& sink) const {
  closest::for_each_sample_block(
      surface, options.progress, "map", [&](std::size_t begin, std::span<const Vec3> points) {
        closest_points(sites, points, options.max_distance,
                       [&](std::size_t first, const sites::ClosestPacket& closest) {
                         sink(begin + first, points.subspan(first, closest.count), closest);
                       });
      });
}

void Engine::scattered(const Sites& sites, std::span<const Vec3> points, const engine::EngineOptions& options,
                       std::span<ClosestPoint> found) const {
  const auto search = [&](std::span<const Vec3> block, const sites::ClosestSink& sink) {
    closest_points(sites, block, options.max_distance, sink);
  };
  closest::find_in_blocks(internals(sites), points, spatial_order(points), search, options.progress, found);
}

}  // namespace sdm

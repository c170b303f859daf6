#include "engine/engine.h"

#include "query/closest/blocks.h"

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

}  // namespace sdm

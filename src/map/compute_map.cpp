#include <sdm/map.h>
#include <sdm/tolerance.h>

#include <array>
#include <atomic>
#include <new>

#include "core/memory.h"
#include "map/engine_of.h"
#include "map/facing_map.h"
#include "map/map_writer.h"
#include "query/inside/inside.h"

namespace sdm {

DistanceMap compute_map(const Surface& surface, const Sites& sites, const MapOptions& options) try {
  DistanceMap map;
  compute_map(surface, sites, options, map);
  return map;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

void compute_map(const Surface& surface, const Sites& sites, const MapOptions& options,
                 DistanceMap& map) try {
  const std::shared_ptr<const Engine> engine = map::engine_of(options);
  if (options.facing) return map::compute_facing_map(surface, sites, options, *engine, map);
  const SignUsed sign = choose_sign(sites, options.sign);
  const inside::InsideTest is_inside(internals(sites), sign.method,
                                     engine_accuracy(engine->info(), surface.mesh(), sites.mesh()));

  map::clear(map, surface);
  const map::MapWriter writer(map, surface);
  map.sign = sign;
  map.measured = {}, map.without_match = 0;
  // Indexed by the samples' position, so that threads rarely write to the same cache line.
  struct alignas(64) Counter {
    std::atomic<std::size_t> count{0};
  };
  std::array<Counter, 64> beyond;
  engine->map(surface, sites, {options.max_distance, options.progress},
              [&](std::size_t first, std::span<const Vec3> points, const sites::ClosestPacket& closest) {
                const std::size_t without = writer.store(first, closest, is_inside(points, closest));
                if (without > 0) beyond[first / 1024 % beyond.size()].count += without;
              });
  map.beyond_max_distance = 0;
  for (const Counter& counter : beyond) map.beyond_max_distance += counter.count;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

}  // namespace sdm

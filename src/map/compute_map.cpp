#include <sdm/error.h>
#include <sdm/map.h>

#include <new>

#include "core/memory.h"
#include "core/numbers/number_text.h"
#include "map/closest_measure.h"

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
  const map::ClosestMeasure measure(surface, sites, options);
  map::TexelStore texels(map, surface, measure.description(), surface.sample_texels());
  measure.engine().map(
      surface, sites, {options.max_distance, options.progress},
      [&](std::size_t first, std::span<const Vec3> points, const sites::ClosestPacket& closest) {
        measure.store(first, points, closest, texels);
      });
  texels.finish();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

MeasuredDistance measured_distance(const MapOptions& options) {
  check_options(options);
  if (!options.facing) return {.settings = settings_of(options)};
  return {DistanceKind::facing,
          "distance to the closest of the faces that face the same way, within " +
              number_text(*options.facing, 6) + "°",
          options.facing, settings_of(options)};
}

SignUsed choose_sign(const Sites& sites, const MapOptions& options) {
  if (!options.facing) return choose_sign(sites, options.sign);
  check_options(options);
  if (options.sign == SignMethod::none) return {SignMethod::none, "asked for"};
  return {SignMethod::side, "by the side of the face that is matched"};
}

}  // namespace sdm

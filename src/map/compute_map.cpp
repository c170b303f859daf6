#include <sdm/error.h>
#include <sdm/map.h>

#include <cmath>
#include <new>
#include <string>

#include "closest/blocks.h"
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

namespace map {

void check_part(const Surface& surface, const SampleRange& range, const DistanceMap& map) {
  if (map.distance.size() != surface.map_faces().size() || map.resolution != surface.resolution())
    throw Error("the map belongs to another surface");
  const std::size_t samples = surface.sample_texels().size(), grain = sample_range_grain(surface);
  const std::size_t end = range.first + range.count;
  if (range.first > samples || range.count > samples - range.first || range.first % grain != 0 ||
      (end % grain != 0 && end != samples))
    throw Error("the range of samples from " + std::to_string(range.first) + " to " + std::to_string(end) +
                " must begin and end at multiples of " + std::to_string(grain) + ", or at the last of the " +
                std::to_string(samples) + " samples");
}

}  // namespace map

std::size_t sample_range_grain(const Surface& surface) {
  return closest::block_size(surface.sample_texels().size());
}

DistanceMap empty_map(const Surface& surface) try {
  DistanceMap map;
  map::clear_all(map, surface);
  return map;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

void compute_samples(const Surface& surface, const Sites& sites, const MapOptions& options,
                     const SampleRange& range, DistanceMap& map) try {
  map::check_part(surface, range, map);
  const map::ClosestMeasure measure(surface, sites, options);
  map::TexelStore texels(map, measure.description(), surface.sample_texels(), range);
  closest::for_each_sample_block(
      surface, range, options.progress, "map", [&](std::size_t begin, std::span<const Vec3> points) {
        measure.engine().closest_points(
            sites, points, options.max_distance, [&](std::size_t first, const sites::ClosestPacket& closest) {
              measure.store(begin + first, points.subspan(first, closest.count), closest, texels);
            });
      });
  texels.finish();
} catch (const std::bad_alloc&) {
  throw out_of_memory("a map");
}

void count_missing(const Surface& surface, DistanceMap& map) {
  if (map.distance.size() != surface.map_faces().size()) throw Error("the map belongs to another surface");
  std::size_t missing = 0;
  map.without_match = 0;
  for (const std::uint32_t texel : surface.sample_texels()) {
    if (std::isfinite(map.distance[texel])) continue;
    ++missing;
    if (!map.unmatched.empty()) map.without_match += map.unmatched[texel];
  }
  map.beyond_max_distance = missing - map.without_match;
}

}  // namespace sdm

// What the gpu engine of JavaScript, js/src/gpu_search.ts, gives a device, and what follows from the faces
// that it finds.
#include <sdm/engine.h>
#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/measure.h>

#include <algorithm>
#include <optional>
#include <variant>
#include <vector>

#include "core/parallel.h"
#include "gpu/finish.h"
#include "gpu/packed_sites.h"
#include "map/closest_measure.h"
#include "module/all_measures.h"
#include "module/arguments.h"
#include "module/result.h"
#include "surface/surface_data.h"

namespace sdm::js {
namespace {

/// Of a map whose results are those of the reference engine.
MapOptions options_of(const Surface& surface, const GivenOptions& given) {
  std::optional<MapOptions> options;
  with_measure(surface.mesh(), {given, {}}, [&](const Measure& measure) {
    if (const auto* closest = std::get_if<MapOptions>(&measure)) options = *closest;
  });
  if (!options) throw Error("the engine gpu has distances to the closest point only");
  options->engine = make_engine("reference");
  options->progress = {};
  return *options;
}

std::vector<Vec3> points_of(const Surface& surface, const SampleRange& range) {
  std::vector<Vec3> points(range.count);
  internals(surface).place_samples(range.first, points);
  return points;
}

/// The last tile is filled with points that are skipped.
std::vector<gpu::QueryPoint> placed_points(const Sites& sites, std::span<const Vec3> points,
                                           double max_distance) {
  constexpr std::size_t kTile = gpu::kTilePoints;
  std::vector<gpu::QueryPoint> placed((points.size() + kTile - 1) / kTile * kTile, {{}, -1});
  gpu::place_points(internals(sites), points, max_distance, placed);
  return placed;
}

}  // namespace

/// Of the present shape: its number, which differs from those of all others, and what bounds errors.
SDM_EXPORT(sdm_gpu_shape) Result* gpu_shape(const Sites* sites) {
  return guarded([&](Result& result) {
    result.put("number", internals(*sites).shape_number);
    result.put("errors", std::vector{gpu::errors_of(internals(*sites))});
  });
}

/// The tree and the faces, from a leaf on, as far as buffers of so many bytes have room.
SDM_EXPORT(sdm_gpu_part)
Result* gpu_part(const Sites* sites, std::uint32_t first_leaf, std::uint32_t most_bytes) {
  return guarded([&](Result& result) {
    gpu::PackedSites part(internals(*sites), first_leaf, most_bytes);
    result.put("first", part.first);
    result.put("end_leaf", part.end_leaf);
    result.put("boxes", std::move(part.boxes));
    result.put("leaves", std::move(part.leaves));
    result.put("faces", std::move(part.faces));
  });
}

/// Samples as points for a device.
SDM_EXPORT(sdm_gpu_points)
Result* gpu_points(const Surface* surface, const Sites* sites, const char* lines, std::uint32_t bytes,
                   const double* numbers, std::uint32_t first, std::uint32_t count) {
  return guarded([&](Result& result) {
    const MapOptions options = options_of(*surface, {lines, bytes, numbers});
    result.put("points", placed_points(*sites, points_of(*surface, {first, count}), options.max_distance));
  });
}

/// The values of samples: of the faces that a device has found, in double precision. `lists`: those of all
/// points of sdm_gpu_points() for the first part, then for the next; `parts`: the first face of each.
SDM_EXPORT(sdm_gpu_finish)
Result* gpu_finish(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                   std::uint32_t bytes, const double* numbers, std::uint32_t first, std::uint32_t count,
                   const gpu::FaceList* lists, const std::uint32_t* parts, std::uint32_t part_count) {
  return guarded([&](Result& result) {
    const SampleRange range{first, count};
    map::check_part(*surface, range, *map);
    const MapOptions options = options_of(*surface, {lines, bytes, numbers});
    const map::ClosestMeasure measure(*surface, *sites, options);
    const std::vector<Vec3> points = points_of(*surface, range);
    const std::vector<gpu::QueryPoint> placed = placed_points(*sites, points, options.max_distance);
    const gpu::FaceLists found{
        .points = placed.size(),
        .first = {parts, parts + part_count},
        .lists = {lists, lists + part_count * placed.size()},
    };
    map::TexelStore texels(*map, measure.description(), surface->sample_texels(), range);
    constexpr std::size_t kGrain = 64 * sites::ClosestPacket::kSize;
    parallel_for((count + kGrain - 1) / kGrain, 1, [&](std::size_t begin, std::size_t end) {
      const std::size_t from = kGrain * begin, size = std::min<std::size_t>(kGrain * end, count) - from;
      const auto part = [&](const auto& all) { return std::span(all).subspan(from, size); };
      gpu::finish(internals(*sites), part(points), part(placed), found, from, options.max_distance,
                  [&](std::size_t at, const sites::ClosestPacket& closest) {
                    const std::span own = std::span(points).subspan(from + at, closest.count);
                    measure.store(first + from + at, own, closest, texels);
                  });
    });
    texels.finish();
    result.put("sign", map->sign.method);
    result.put("sign_reason", map->sign.reason);
  });
}

}  // namespace sdm::js

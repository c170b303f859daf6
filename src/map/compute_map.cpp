#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/map.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

#include "core/parallel.h"
#include "core/spatial_order.h"
#include "core/stopwatch.h"
#include "core/vec.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/point_group.h"
#include "engine/engine.h"
#include "engine/gl/gl_engine.h"
#include "inside/inside_test.h"
#include "map/map_writer.h"
#include "sites/closest_on_face.h"
#include "surface/surface_data.h"

namespace sdm {
namespace {

// Calls body(begin, end) for aligned runs of points in spatial order, as long as the cpu engine can use, but
// numerous enough to distribute evenly.
void for_each_run(std::size_t count, const Progress& progress, std::string_view step,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  constexpr std::size_t kEnough = 32;
  std::size_t run = cpu::PointGroup::kMostPoints;
  while (run > cpu::PointGroup::kPacket && count < kEnough * run) run /= cpu::PointGroup::kFan;
  parallel_for((count + run - 1) / run, 1, progress, step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(run * i, std::min(count, run * (i + 1)));
  });
}

void check(const MapOptions& options) {
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
}

// Delivers the closest points of texels by their winners. Returns for how many these were not confirmed.
std::size_t recompute(const sites::SitesData& sites, const RasterWinners& winners,
                      std::span<const std::uint32_t> texels, std::span<const Vec3> points,
                      double max_distance, const engine::ClosestSink& deliver) {
  std::size_t unconfirmed = 0;
  sites::ClosestPacket packet;
  for (std::size_t first = 0; first < texels.size(); first += packet.count) {
    packet.count = std::min(sites::ClosestPacket::kSize, texels.size() - first);
    for (std::size_t i = 0; i < packet.count; ++i) {
      const std::uint32_t texel = texels[first + i], face = winners.faces[texel];
      ClosestPoint closest;
      if (face != kNone) closest = sites::closest_around_face(sites, face, points[first + i]);
      const bool confirmed = face == kNone || winners.confirms(texel, closest.distance);
      packet.set(i, points[first + i], closest.distance <= max_distance ? closest : ClosestPoint{});
      if (confirmed) continue;
      ++unconfirmed;
      cpu::cpu_search(sites, points.subspan(first + i, 1), max_distance,
                      [&](std::size_t, const sites::ClosestPacket& found) {
                        packet.set(i, points[first + i], found.get(0, points[first + i]));
                      });
    }
    deliver(first, packet);
  }
  return unconfirmed;
}

}  // namespace

DistanceMap compute_map(const Surface& surface, const Sites& sites, const MapOptions& options) {
  DistanceMap map;
  compute_map(surface, sites, options, map);
  return map;
}

void compute_map(const Surface& surface, const Sites& sites, const MapOptions& options, DistanceMap& map) {
  check(options);
  const SignUsed sign = choose_sign(sites, options.sign);
  const inside::InsideTest is_inside(internals(sites), sign.method);

  const bool raster = options.engine == EngineKind::gl;
  GlReport report;
  RasterWinners winners;
  if (raster) winners = gl_winners(surface, sites, options, report);
  const engine::ClosestSearch search = raster ? nullptr : engine::search_of(options.engine);
  Stopwatch watch;

  const map::MapWriter writer(map, surface);
  map.sign = sign;
  const std::size_t count = surface.sample_texels().size();
  std::atomic<std::size_t> beyond{0}, unconfirmed{0};
  for_each_run(count, options.progress, raster ? "finish" : "map", [&](std::size_t begin, std::size_t end) {
    const std::span<const std::uint32_t> texels = surface.sample_texels().subspan(begin, end - begin);
    thread_local std::vector<Vec3> points;  // of one block only: those of all samples would take much memory
    points.resize(end - begin);
    internals(surface).place_samples(begin, points);
    std::size_t beyond_here = 0;
    const auto store = [&](std::size_t first, const sites::ClosestPacket& closest) {
      const std::span packet = std::span(points).subspan(first, closest.count);
      beyond_here += writer.store(begin + first, closest, is_inside(packet, closest));
    };
    if (raster)
      unconfirmed += recompute(internals(sites), winners, texels, points, options.max_distance, store);
    else
      search(internals(sites), points, options.max_distance, store);
    beyond += beyond_here;
  });
  map.beyond_max_distance = beyond;
  if (raster) {
    report.unconfirmed = unconfirmed;
    report.time_ms.finish = watch.lap();
    map.raster = std::move(report);
  }
}

std::vector<ClosestPoint> closest_points(const Sites& sites, std::span<const Vec3> points,
                                         const MapOptions& options) {
  check(options);
  constexpr double kMaxCoordinate = 1e37;  // as for meshes
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!(std::abs(x) <= kMaxCoordinate))
        throw Error("query point " + std::to_string(i) + " has a coordinate that is NaN or beyond 1e37");
  const engine::ClosestSearch search = engine::search_of(options.engine);
  const std::vector<std::uint32_t> order = spatial_order(points);
  std::vector<ClosestPoint> result(points.size());
  for_each_run(points.size(), options.progress, "closest points", [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> batch(end - begin);
    for (std::size_t i = begin; i < end; ++i) batch[i - begin] = points[order[i]];
    search(internals(sites), batch, options.max_distance,
           [&](std::size_t first, const sites::ClosestPacket& closest) {
             for (std::size_t i = 0; i < closest.count; ++i) {
               ClosestPoint& c = result[order[begin + first + i]] = closest.get(i, batch[first + i]);
               if (c.type != SiteType::none) c.face = internals(sites).face_of(c.type, c.site);
             }
           });
  });
  return result;
}

}  // namespace sdm

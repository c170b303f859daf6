#include <sdm/error.h>
#include <sdm/map.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/spatial_order.h"
#include "core/vec.h"
#include "engine/closest_on_face.h"
#include "engine/engine.h"
#include "engine/gl/gl_engine.h"
#include "engine/sign.h"

namespace sdm {
namespace {

// Points that one thread takes at a time: enough to amortise the start of a search, few enough to share
// evenly.
constexpr std::size_t kBatch = 2048;

DistanceMap empty_map(std::uint32_t resolution) {
  const std::size_t texels = std::size_t{resolution} * resolution;
  require_memory(texels * (sizeof(float) + sizeof(Vec3f) + sizeof(std::uint32_t) + sizeof(SiteType)),
                 "a map of " + std::to_string(resolution) + "² texels");
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  DistanceMap map;
  map.resolution = resolution;
  map.distance.assign(texels, nan);
  map.vector.assign(texels, {nan, nan, nan});
  map.site.assign(texels, kNone);
  map.site_type.assign(texels, SiteType::none);
  return map;
}

void check(const MapOptions& options) {
  if (!(options.max_distance > 0)) throw Error("the maximum distance must be greater than 0");
}

// The closest points of texels by their winners. Returns for how many these were not confirmed.
std::size_t recompute(const Sites::Impl& sites, const RasterWinners& winners,
                      std::span<const std::uint32_t> texels, std::span<const Vec3> points,
                      double max_distance, std::span<ClosestPoint> closest) {
  std::size_t unconfirmed = 0;
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const std::uint32_t face = winners.faces[texels[i]];
    if (face == kNone) continue;
    closest[i] = closest_around_face(sites, face, points[i]);
    if (!winners.confirms(texels[i], closest[i].distance)) {
      ++unconfirmed;
      cpu_search(sites, points.subspan(i, 1), max_distance, closest.subspan(i, 1));
    }
    if (closest[i].distance > max_distance) closest[i] = {};
  }
  return unconfirmed;
}

}  // namespace

ClosestSearch search_of(EngineKind engine) {
  if (engine == EngineKind::gl)
    throw Error("the gl engine computes maps only: for closest points choose cpu or reference");
  return engine == EngineKind::reference ? reference_search : cpu_search;
}

DistanceMap compute_map(const Surface& surface, const Sites& sites, const MapOptions& options) {
  check(options);
  const SignUsed sign = choose_sign(sites, options.sign);
  const InsideTest is_inside(sites.impl(), sign.method);

  const bool raster = options.engine == EngineKind::gl;
  RasterReport report;
  RasterWinners winners;
  if (raster) winners = gl_winners(surface, sites, options, report);
  const ClosestSearch search = raster ? nullptr : search_of(options.engine);
  const auto start = std::chrono::steady_clock::now();

  DistanceMap map = empty_map(surface.resolution());
  map.sign = sign;
  const std::span<const std::uint32_t> samples = surface.samples();
  std::atomic<std::size_t> beyond{0}, unconfirmed{0};
  parallel_for(
      samples.size(), kBatch, options.progress, raster ? "finish" : "map",
      [&](std::size_t begin, std::size_t end) {
        const std::span<const std::uint32_t> texels = samples.subspan(begin, end - begin);
        std::vector<Vec3> points(texels.size());
        std::vector<ClosestPoint> closest(texels.size());
        std::transform(texels.begin(), texels.end(), points.begin(),
                       [&](std::uint32_t texel) { return surface.texel_point(texel); });
        if (raster)
          unconfirmed += recompute(sites.impl(), winners, texels, points, options.max_distance, closest);
        else
          search(sites.impl(), points, options.max_distance, closest);
        for (std::size_t i = 0; i < texels.size(); ++i) {
          const ClosestPoint& c = closest[i];
          if (c.type == SiteType::none) {
            ++beyond;
            continue;
          }
          const Vec3 vector = c.point - points[i];
          const std::uint32_t texel = texels[i];
          map.distance[texel] = static_cast<float>(is_inside(points[i], c) ? -c.distance : c.distance);
          for (int k = 0; k < 3; ++k) map.vector[texel][k] = static_cast<float>(vector[k]);
          map.site[texel] = c.site;
          map.site_type[texel] = c.type;
        }
      });
  map.beyond_max_distance = beyond;
  if (raster) {
    report.unconfirmed = unconfirmed;
    report.time_ms.finish =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    map.raster = std::move(report);
  }
  return map;
}

std::vector<ClosestPoint> closest_points(const Sites& sites, std::span<const Vec3> points,
                                         const MapOptions& options) {
  check(options);
  constexpr double kMaxCoordinate = 1e37;  // as for meshes
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double x : points[i])
      if (!(std::abs(x) <= kMaxCoordinate))
        throw Error("query point " + std::to_string(i) + " has a coordinate that is NaN or beyond 1e37");
  const ClosestSearch search = search_of(options.engine);
  const std::vector<std::uint32_t> order = spatial_order(points);
  std::vector<ClosestPoint> result(points.size());
  parallel_for(points.size(), kBatch, options.progress, "closest points",
               [&](std::size_t begin, std::size_t end) {
                 std::vector<Vec3> batch(end - begin);
                 std::vector<ClosestPoint> closest(end - begin);
                 for (std::size_t i = begin; i < end; ++i) batch[i - begin] = points[order[i]];
                 search(sites.impl(), batch, options.max_distance, closest);
                 for (std::size_t i = begin; i < end; ++i) result[order[i]] = closest[i - begin];
               });
  return result;
}

}  // namespace sdm

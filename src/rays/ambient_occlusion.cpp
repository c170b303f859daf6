#include <sdm/error.h>
#include <sdm/rays.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/memory.h"
#include "core/parallel.h"
#include "rays/hemisphere_rays.h"
#include "surface/surface_data.h"

namespace sdm {
namespace {

/// The largest error of a distance by any engine, in units of the meshes.
double largest_error(const Surface& surface, const Sites& sites) {
  EngineInfo worst = engines().front();
  for (const EngineInfo& engine : engines())
    worst.relative_error = std::max(worst.relative_error, engine.relative_error);
  return engine_accuracy(worst, surface.mesh(), sites.mesh());
}

void check_resolution(const Surface& surface, const DistanceMap& map, const char* function) {
  if (map.distance.size() != surface.map_faces().size())
    throw Error(std::string(function) + "() needs a map of the surface: their resolutions differ");
  if (!is_lipschitz(map.measured.kind))
    throw Error(std::string(function) + "() needs a map of distances to the closest point");
}

double free_distance(float distance, double error) {
  return std::isnan(distance) ? 0 : std::max(0.0, std::abs(static_cast<double>(distance)) - error);
}

}  // namespace

std::vector<double> free_distances(const Surface& surface, const Sites& sites, const DistanceMap& map) {
  check_resolution(surface, map, "free_distances");
  const double error = largest_error(surface, sites);
  std::vector<double> result(map.texels());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = free_distance(map.distance[i], error);
  return result;
}

std::vector<float> ambient_occlusion(const Surface& surface, const Sites& sites, const DistanceMap& map,
                                     const AmbientOcclusionOptions& options) try {
  constexpr std::size_t kGrain = 16;
  check_resolution(surface, map, "ambient_occlusion");
  check_options(options);
  const surface::SurfaceData& on = internals(surface);
  const double error = largest_error(surface, sites);
  std::vector<float> result(map.texels(), std::numeric_limits<float>::quiet_NaN());
  parallel_for(on.samples.size(), kGrain, options.progress, "ambient occlusion",
               [&](std::size_t begin, std::size_t end) {
                 thread_local rays::HemisphereRays some;
                 thread_local std::vector<Vec3> points;
                 some.resize(options.rays);
                 points.resize(end - begin);
                 on.place_samples(begin, points);
                 for (std::size_t i = begin; i < end; ++i) {
                   const std::uint32_t texel = on.samples[i];
                   if (texel >= result.size()) continue;
                   const double free = free_distance(map.distance[texel], error);
                   if (free > options.max_distance) {
                     result[texel] = 1;
                     continue;
                   }
                   const auto& [a, b, c] = on.mesh.triangles[on.sample_faces[i]];
                   const std::vector<Vec3>& p = on.mesh.positions;
                   const Ray first{points[i - begin], {}, free, options.max_distance};
                   result[texel] =
                       some.visibility(internals(sites), first, normalized(cross(p[b] - p[a], p[c] - p[a])),
                                       options.seed, texel);
                 }
               });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("ambient occlusion");
}

}  // namespace sdm

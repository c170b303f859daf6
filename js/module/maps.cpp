// Surfaces, sites, and the maps of a surface to sites.
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>
#include <sdm/transfer.h>

#include <cmath>

#include "module/arguments.h"
#include "module/lengths.h"
#include "module/result.h"

namespace sdm::js {

SDM_EXPORT(sdm_new_surface)
Result* new_surface(const double* positions, std::uint32_t vertices, const std::uint32_t* indices,
                    std::uint32_t triangles, const double* corner_uvs, std::uint32_t kind,
                    std::uint32_t resolution, std::uint32_t gutter) {
  return guarded([&](Result& result) {
    Mesh made = mesh(positions, vertices, indices, triangles);
    if (corner_uvs) {
      const std::span uvs(reinterpret_cast<const std::array<Vec2, 3>*>(corner_uvs), triangles);
      made.corner_uvs.assign(uvs.begin(), uvs.end());
    }
    result.add_object(
        std::make_unique<Surface>(std::move(made), AtlasOptions{.kind = static_cast<AtlasKind>(kind),
                                                                .resolution = resolution,
                                                                .gutter = gutter,
                                                                .progress = host_progress()}));
  });
}

SDM_EXPORT(sdm_free_surface) void free_surface(Surface* surface) {
  delete surface;
}

SDM_EXPORT(sdm_refit_surface)
Result* refit_surface(Surface* surface, const double* positions, std::uint32_t vertices) {
  return guarded([&](Result&) { surface->refit(points(positions, vertices)); });
}

/// The resolution and rows, and for each texel its face; of each triangle, the atlas coordinates of its
/// corners, in texels (NaN: the face has no chart).
SDM_EXPORT(sdm_surface_atlas) Result* surface_atlas(const Surface* surface) {
  return guarded([&](Result& result) {
    result.add_numbers(surface->resolution(), surface->rows(), surface->chart_count(),
                       surface->utilisation());
    const auto faces = surface->texel_faces();
    result.add(std::vector<std::uint32_t>(faces.begin(), faces.end()));
    const auto charts = surface->face_charts();
    std::vector<float> corners(charts.size() * 6, NAN);
    for (std::uint32_t face = 0; face < charts.size(); ++face) {
      if (charts[face] == kNone) continue;
      const auto of_face = surface->atlas_corners(face);
      for (std::size_t k = 0; k < 3; ++k) {
        corners[face * 6 + 2 * k] = static_cast<float>(of_face[k][0]);
        corners[face * 6 + 2 * k + 1] = static_cast<float>(of_face[k][1]);
      }
    }
    result.add(std::move(corners));
  });
}

SDM_EXPORT(sdm_surface_samples) Result* surface_samples(const Surface* surface) {
  return guarded([&](Result& result) {
    const auto texels = surface->sample_texels();
    result.add(std::vector<std::uint32_t>(texels.begin(), texels.end()));
    result.add(surface->sample_points());
  });
}

SDM_EXPORT(sdm_new_sites)
Result* new_sites(const double* positions, std::uint32_t vertices, const std::uint32_t* indices,
                  std::uint32_t triangles) {
  return guarded([&](Result& result) {
    auto sites = std::make_unique<Sites>(mesh(positions, vertices, indices, triangles));
    const bool closed = sites->closed(), orientable = sites->orientable();
    result.add_object(std::move(sites));
    result.add_numbers(closed, orientable);
  });
}

SDM_EXPORT(sdm_free_sites) void free_sites(Sites* sites) {
  delete sites;
}

SDM_EXPORT(sdm_refit_sites)
Result* refit_sites(Sites* sites, const double* positions, std::uint32_t vertices) {
  return guarded([&](Result&) { sites->refit(points(positions, vertices)); });
}

SDM_EXPORT(sdm_new_map)
Result* new_map(const Surface* surface, const Sites* sites, std::uint32_t sign, double max_distance,
                double facing) {
  return guarded([&](Result& result) {
    MapOptions options{
        .sign = static_cast<SignMethod>(sign), .max_distance = max_distance, .progress = host_progress()};
    if (!std::isnan(facing)) options.facing = facing;
    auto map = std::make_unique<DistanceMap>(compute_map(*surface, *sites, options));
    const SignUsed sign_used = map->sign;
    const double resolution = map->resolution, rows = map->rows();
    result.add_object(std::move(map));
    result.add_numbers(resolution, rows, static_cast<int>(sign_used.method));
    result.add_text(sign_used.reason);
  });
}

SDM_EXPORT(sdm_free_map) void free_map(DistanceMap* map) {
  delete map;
}

/// Of a map: 0: distances, 1: vectors, 2: sites, 3: types of sites. Copied by JavaScript, not here.
SDM_EXPORT(sdm_map_array) const void* map_array(const DistanceMap* map, std::uint32_t which) {
  switch (which) {
    case 0:
      return map->distance.data();
    case 1:
      return map->vector.data();
    case 2:
      return map->site.data();
    default:
      return map->site_type.data();
  }
}

SDM_EXPORT(sdm_map_statistics) Result* map_statistics(const Surface* surface, const DistanceMap* map) {
  return guarded([&](Result& result) {
    const DistanceStatistics s = statistics(*surface, *map);
    result.add_numbers(s.texels, s.negative_texels, s.negative_area_fraction, s.min, s.max, s.mean, s.rms,
                       s.stddev, s.p01, s.p05, s.p50, s.p95, s.p99, s.mean_abs, s.max_abs, s.p50_abs,
                       s.p95_abs, s.p99_abs);
  });
}

SDM_EXPORT(sdm_transfer)
Result* transfer_values(const Surface* surface, const Sites* sites, const DistanceMap* map,
                        const float* values, std::uint32_t count, std::uint32_t components,
                        std::uint32_t domain, bool fill) {
  return guarded([&](Result& result) {
    result.add(transfer(
        *surface, *sites, *map,
        {.values = {values, count}, .components = components, .domain = static_cast<AttributeDomain>(domain)},
        {.fill = fill, .progress = host_progress()}));
  });
}

SDM_EXPORT(sdm_hausdorff) Result* hausdorff(const Sites* a, const Sites* b, double precision) {
  return guarded([&](Result& result) {
    HausdorffOptions options{.progress = host_progress()};
    if (precision > 0) options.precision = precision;
    const SymmetricHausdorff both = symmetric_hausdorff(*a, *b, options);
    for (const HausdorffDistance* one : {&both.from[0], &both.from[1], &both.larger}) {
      add_length(result, one->distance);
      result.add(std::vector<std::uint32_t>(one->faces.begin(), one->faces.end()));
    }
    result.add_numbers(both.larger_from);
  });
}

}  // namespace sdm::js

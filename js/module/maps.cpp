// Surfaces, sites, and the maps of a surface to sites.
#include <sdm/error.h>
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/sampling_bound.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "module/arguments.h"
#include "module/measures.h"
#include "module/options.h"
#include "module/result.h"
#include "module/transferred.h"

namespace sdm::js {

SDM_EXPORT(sdm_new_surface)
Result* new_surface(const double* positions, std::uint32_t vertices, const std::uint32_t* indices,
                    std::uint32_t triangles, const double* corner_uvs, const char* lines, std::uint32_t bytes,
                    const double* numbers, const std::uint8_t* stored_atlas, std::uint32_t stored_bytes) {
  return guarded([&](Result& result) {
    auto [options, fit] = read_all_options<AtlasOptions, PrecisionOptions>({lines, bytes, numbers});
    options.progress = host_progress();
    Mesh made = mesh(positions, vertices, indices, triangles);
    if (corner_uvs) {
      const std::span uvs(reinterpret_cast<const std::array<Vec2, 3>*>(corner_uvs), triangles);
      made.corner_uvs.assign(uvs.begin(), uvs.end());
    }
    options.resolution = resolution_for(made, fit, options);
    result.put_object(stored_atlas ? std::make_unique<Surface>(std::move(made), options,
                                                               std::span(stored_atlas, stored_bytes))
                                   : std::make_unique<Surface>(std::move(made), options));
  });
}

/// The atlas as bytes, for sdm_new_surface() in another module.
SDM_EXPORT(sdm_stored_atlas) Result* stored_atlas(const Surface* surface) {
  return guarded([&](Result& result) { result.put("atlas", surface->stored_atlas()); });
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
    result.put("resolution", surface->resolution());
    result.put("rows", surface->rows());
    result.put("charts", surface->chart_count());
    result.put("utilisation", surface->utilisation());
    result.put_view("texel_faces", surface->texel_faces());
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
    result.put("corners", std::move(corners));
  });
}

/// The number of samples, and that of which ranges begin and end at multiples.
SDM_EXPORT(sdm_sample_counts) Result* sample_counts(const Surface* surface) {
  return guarded([&](Result& result) {
    result.put("samples", surface->sample_texels().size());
    result.put("grain", sample_range_grain(*surface));
  });
}

SDM_EXPORT(sdm_surface_samples) Result* surface_samples(const Surface* surface) {
  return guarded([&](Result& result) {
    result.put_view("texels", surface->sample_texels());
    result.put("points", surface->sample_points());
  });
}

SDM_EXPORT(sdm_new_sites)
Result* new_sites(const double* positions, std::uint32_t vertices, const std::uint32_t* indices,
                  std::uint32_t triangles) {
  return guarded([&](Result& result) {
    auto sites = std::make_unique<Sites>(mesh(positions, vertices, indices, triangles));
    result.put("closed", sites->closed());
    result.put("orientable", sites->orientable());
    result.put_object(std::move(sites));
  });
}

SDM_EXPORT(sdm_free_sites) void free_sites(Sites* sites) {
  delete sites;
}

SDM_EXPORT(sdm_refit_sites)
Result* refit_sites(Sites* sites, const double* positions, std::uint32_t vertices) {
  return guarded([&](Result&) { sites->refit(points(positions, vertices)); });
}

namespace {

void put_sign(Result& result, const DistanceMap& map) {
  result.put("sign", map.sign.method);
  result.put("sign_reason", map.sign.reason);
}

/// Calls visit(name, values) for each array of a map, by the names that js/src/types.ts has for them.
template <class Visit>
void for_each_array(const DistanceMap& map, const Visit& visit) {
  visit("distances", map.distance);
  visit("vectors", map.vector);
  visit("sites_of_texels", map.site);
  visit("site_types", map.site_type);
}

}  // namespace

/// A map without values.
SDM_EXPORT(sdm_new_map) Result* new_map(const Surface* surface) {
  return guarded([&](Result& result) {
    auto map = std::make_unique<DistanceMap>(empty_map(*surface));
    result.put("resolution", map->resolution);
    result.put("rows", map->rows());
    result.put_object(std::move(map));
  });
}

SDM_EXPORT(sdm_compute_map)
Result* compute_whole_map(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                          std::uint32_t bytes, const double* numbers, const double* rest,
                          std::uint32_t vertices) {
  return guarded([&](Result& result) {
    measure(*surface, *sites, {{lines, bytes, numbers}, points(rest, vertices)}, *map);
    put_sign(result, *map);
  });
}

SDM_EXPORT(sdm_compute_samples)
Result* compute_range(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                      std::uint32_t bytes, const double* numbers, const double* rest, std::uint32_t vertices,
                      std::uint32_t first, std::uint32_t count) {
  return guarded([&](Result& result) {
    measure_samples(*surface, *sites, {{lines, bytes, numbers}, points(rest, vertices)}, {first, count},
                    *map);
    put_sign(result, *map);
  });
}

/// The arrays of the map for a range of samples, in their order.
SDM_EXPORT(sdm_map_samples)
Result* map_samples(const DistanceMap* map, const Surface* surface, std::uint32_t first,
                    std::uint32_t count) {
  return guarded([&](Result& result) {
    const auto all = surface->sample_texels();
    if (map->distance.size() != surface->map_faces().size() || first > all.size() ||
        count > all.size() - first)
      throw Error("the samples are not of this map");
    const auto texels = all.subspan(first, count);
    for_each_array(*map, [&](const char* name, const auto& values) {
      std::remove_cvref_t<decltype(values)> picked(texels.size());
      for (std::size_t i = 0; i < texels.size(); ++i) picked[i] = values[texels[i]];
      result.put(name, std::move(picked));
    });
  });
}

SDM_EXPORT(sdm_free_map) void free_map(DistanceMap* map) {
  delete map;
}

/// An array of a map, by the name that JavaScript has for it. Copied by JavaScript, not here.
SDM_EXPORT(sdm_map_array)
Result* map_array(const DistanceMap* map, const char* name, std::uint32_t size) {
  return guarded([&](Result& result) {
    for_each_array(*map, [&](const char* own, const auto& values) {
      if (spelled(own, Spelling::camel_case) == std::string_view(name, size))
        result.put_view("values", std::span(values).first(map->texels()));
    });
  });
}

SDM_EXPORT(sdm_map_statistics) Result* map_statistics(const Surface* surface, const DistanceMap* map) {
  return guarded([&](Result& result) { result.put_fields("", statistics(*surface, *map)); });
}

SDM_EXPORT(sdm_transfer)
Result* transfer_values(const Surface* surface, const Sites* sites, const DistanceMap* map,
                        const float* values, std::uint32_t count, const char* lines, std::uint32_t bytes,
                        const double* numbers) {
  return transferred(surface, sites, map, {values, count}, {lines, bytes, numbers});
}

SDM_EXPORT(sdm_hausdorff)
Result* hausdorff(const Sites* a, const Sites* b, const char* lines, std::uint32_t bytes,
                  const double* numbers) {
  return guarded([&](Result& result) {
    auto options = read_options<HausdorffOptions>({lines, bytes, numbers});
    options.progress = host_progress();
    const SymmetricHausdorff both = symmetric_hausdorff(*a, *b, options);
    result.put_fields("from/0/", both.from[0].distance);
    result.put_fields("from/1/", both.from[1].distance);
    result.put_fields("larger/", both.larger.distance);
  });
}

}  // namespace sdm::js

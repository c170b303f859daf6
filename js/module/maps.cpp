// Surfaces, sites, and the maps of a surface to sites.
#include <sdm/error.h>
#include <sdm/hausdorff.h>
#include <sdm/io.h>
#include <sdm/map.h>
#include <sdm/map_samples.h>
#include <sdm/sampling_bound.h>
#include <sdm/sites.h>
#include <sdm/statistics.h>
#include <sdm/surface.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "module/arguments.h"
#include "module/lengths.h"
#include "module/options.h"
#include "module/result.h"
#include "module/transferred.h"

namespace sdm::js {

namespace {

template <Worded Enum>
void add_words(std::string& lines, const char* option) {
  lines += option;
  for (const char* const word : kWords<Enum>) lines.append(" ").append(word);
  lines += "\n";
}

}  // namespace

/// The words that options and results may have, in the order of their numbers: a line for each, after its
/// name.
SDM_EXPORT(sdm_words) Result* words() {
  return guarded([](Result& result) {
    std::string lines;
    add_words<SignMethod>(lines, "sign");
    add_words<AtlasKind>(lines, "atlas");
    add_words<Certainty>(lines, "certainty");
    add_words<AttributeDomain>(lines, "domain");
    add_words<MatchMethod>(lines, "method");
    add_words<Colormap>(lines, "colormap");
    add_words<UpAxis>(lines, "up");
    result.add_text(lines);
  });
}

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
    result.add_object(stored_atlas ? std::make_unique<Surface>(std::move(made), options,
                                                               std::span(stored_atlas, stored_bytes))
                                   : std::make_unique<Surface>(std::move(made), options));
  });
}

/// The atlas as bytes, for sdm_new_surface() in another module.
SDM_EXPORT(sdm_stored_atlas) Result* stored_atlas(const Surface* surface) {
  return guarded([&](Result& result) { result.add(surface->stored_atlas()); });
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

/// The number of samples, and that of which ranges begin and end at multiples.
SDM_EXPORT(sdm_sample_counts) Result* sample_counts(const Surface* surface) {
  return guarded([&](Result& result) {
    result.add_numbers(surface->sample_texels().size(), sample_range_grain(*surface));
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

namespace {

MapOptions map_options(const GivenOptions& given) {
  auto options = read_options<MapOptions>(given);
  options.progress = host_progress();
  return options;
}

void add_sign(Result& result, const DistanceMap& map) {
  result.add_numbers(static_cast<int>(map.sign.method));
  result.add_text(map.sign.reason);
}

}  // namespace

/// A map without values.
SDM_EXPORT(sdm_new_map) Result* new_map(const Surface* surface) {
  return guarded([&](Result& result) {
    auto map = std::make_unique<DistanceMap>(empty_map(*surface));
    const double resolution = map->resolution, rows = map->rows();
    result.add_object(std::move(map));
    result.add_numbers(resolution, rows);
  });
}

SDM_EXPORT(sdm_compute_map)
Result* compute_whole_map(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                          std::uint32_t bytes, const double* numbers) {
  return guarded([&](Result& result) {
    compute_map(*surface, *sites, map_options({lines, bytes, numbers}), *map);
    add_sign(result, *map);
  });
}

SDM_EXPORT(sdm_compute_samples)
Result* compute_range(DistanceMap* map, const Surface* surface, const Sites* sites, const char* lines,
                      std::uint32_t bytes, const double* numbers, std::uint32_t first, std::uint32_t count) {
  return guarded([&](Result& result) {
    compute_samples(*surface, *sites, map_options({lines, bytes, numbers}), {first, count}, *map);
    add_sign(result, *map);
  });
}

/// The values of a range of samples, in their order: distances, vectors, sites, types of sites.
SDM_EXPORT(sdm_map_samples)
Result* map_samples(const DistanceMap* map, const Surface* surface, std::uint32_t first,
                    std::uint32_t count) {
  return guarded([&](Result& result) {
    const auto all = surface->sample_texels();
    if (map->distance.size() != surface->map_faces().size() || first > all.size() ||
        count > all.size() - first)
      throw Error("the samples are not of this map");
    const auto texels = all.subspan(first, count);
    const auto add = [&](const auto& values) {
      std::remove_cvref_t<decltype(values)> picked(texels.size());
      for (std::size_t i = 0; i < texels.size(); ++i) picked[i] = values[texels[i]];
      result.add(std::move(picked));
    };
    add(map->distance), add(map->vector), add(map->site), add(map->site_type);
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
  return guarded([&](Result& result) { result.add_fields(statistics(*surface, *map)); });
}

SDM_EXPORT(sdm_transfer)
Result* transfer_values(const Surface* surface, const Sites* sites, const DistanceMap* map,
                        const float* values, std::uint32_t count, std::uint32_t components,
                        std::uint32_t domain, bool fill) {
  return transferred(surface, sites, map, values, count, components, domain, fill);
}

SDM_EXPORT(sdm_hausdorff)
Result* hausdorff(const Sites* a, const Sites* b, const char* lines, std::uint32_t bytes,
                  const double* numbers) {
  return guarded([&](Result& result) {
    auto options = read_options<HausdorffOptions>({lines, bytes, numbers});
    options.progress = host_progress();
    const SymmetricHausdorff both = symmetric_hausdorff(*a, *b, options);
    for (const HausdorffDistance* one : {&both.from[0], &both.from[1], &both.larger}) {
      add_length(result, one->distance);
      result.add(std::vector<std::uint32_t>(one->faces.begin(), one->faces.end()));
    }
    result.add_numbers(both.larger_from);
  });
}

}  // namespace sdm::js

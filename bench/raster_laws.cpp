#include "raster_laws.h"

namespace sdm::bench {

std::vector<std::string> broken_laws(const Surface& surface, const DistanceMap& map, const GlReport& report,
                                     const GlOptions& options) {
  const GlReport& r = report;
  const bool stencil = options.clip == GlClip::stencil;
  const std::uint64_t values_in_use = r.stencil_misses - r.stencil_evictions;
  std::vector<std::string> broken;
  const auto law = [&broken](bool holds, const char* words) {
    if (!holds) broken.emplace_back(words);
  };
  law(r.faces <= r.tiles && r.tiles <= r.texels, "faces <= tiles <= texels");
  law(r.pairs == (r.sites - r.sites_dropped) * r.tiles, "pairs = (sites - sites_dropped) * tiles");
  law(r.pairs == r.culled_by_bound + r.culled_by_obb + r.clipped_away + r.polygons,
      "pairs = culled_by_bound + culled_by_obb + clipped_away + polygons");
  law(options.bound_culling || r.culled_by_bound == 0, "without bounds culled_by_bound = 0");
  law(r.texels == surface.sample_texels().size(), "texels = those that a face owns");
  law(r.fragments >= r.texels - map.beyond_max_distance, "fragments >= texels with a value");
  law(r.stencil_lookups == r.stencil_hits + r.stencil_misses, "lookups = hits + misses");
  law(r.stencil_evictions <= r.stencil_misses &&
          values_in_use <= static_cast<std::uint64_t>(options.stencil_values),
      "0 <= misses - evictions <= stencil_values");
  law(r.stencil_clears == (stencil ? r.stencil_evictions + 1 : 0),
      "clears = evictions + 1 by stencil, else 0");
  law(stencil == (r.stencil_lookups > 0), "lookups by stencil only");
  return broken;
}

}  // namespace sdm::bench

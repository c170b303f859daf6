#include "gl_counters.h"
#include "gl/raster_report.h"

namespace sdm::bench {

std::vector<std::string> violated_relations(const Surface& surface, const DistanceMap& map,
                                            const gl::RasterReport& r, const GlOptions& options) {
  const bool stencil = options.clip == GlClip::stencil;
  const std::uint64_t values_in_use = r.stencil_misses - r.stencil_evictions;
  std::vector<std::string> violated;
  const auto check = [&violated](bool holds, const char* words) {
    if (!holds) violated.emplace_back(words);
  };
  check(r.faces <= r.tiles && r.tiles <= r.texels, "faces <= tiles <= texels");
  check(r.pairs == (r.sites - r.sites_dropped) * r.tiles, "pairs = (sites - sites_dropped) * tiles");
  check(r.pairs == r.culled_by_bound + r.culled_by_obb + r.clipped_away + r.polygons,
        "pairs = culled_by_bound + culled_by_obb + clipped_away + polygons");
  check(options.bound_culling || r.culled_by_bound == 0, "without bounds culled_by_bound = 0");
  check(r.texels == surface.owned_texels(), "texels = those that a face owns");
  check(r.fragments >= r.texels - map.beyond_max_distance, "fragments >= texels with a value");
  check(r.stencil_lookups == r.stencil_hits + r.stencil_misses, "lookups = hits + misses");
  check(r.stencil_evictions <= r.stencil_misses &&
            values_in_use <= static_cast<std::uint64_t>(options.stencil_values),
        "0 <= misses - evictions <= stencil_values");
  check(r.stencil_clears == (stencil ? r.stencil_evictions + 1 : 0),
        "clears = evictions + 1 by stencil, else 0");
  check(stencil == (r.stencil_lookups > 0), "lookups by stencil only");
  return violated;
}

}  // namespace sdm::bench

#include <sdm/bake.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <vector>

#include "baking/geometry/texel_walk.h"
#include "closest/facing/outward_normals.h"
#include "core/memory.h"
#include "geometry/vec.h"
#include "map/measures/thickness_measure.h"
#include "rays/hemisphere_rays.h"

namespace sdm {

std::vector<float> matched_occlusion(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                     const AmbientOcclusionOptions& options) try {
  require_matches(surface, sites, matches);
  check_options(options);
  constexpr double kAbove = 1e-6;  // of the diagonal: more than the rounding of points
  const sites::SitesData& data = internals(sites);
  const double above = kAbove * diagonal(bounds(data.mesh));
  std::vector<float> values = baking::no_values(matches, 1, "the ambient occlusion of matches");
  baking::for_each_texel(
      surface, options.progress, "ambient occlusion", [&] { return rays::HemisphereRays(options.rays); },
      [&](std::uint32_t texel, rays::HemisphereRays& rays) {
        const SurfacePoint point = matches.point(texel);
        if (point.face == kNone) return;
        const Vec3 normal = facing::outward_normal(data, point.face);
        if (normal == Vec3{}) return;
        const Ray first{baking::position_of(data.mesh, point) + above * normal, {}, 0, options.max_distance};
        values[texel] = rays.visibility(data, first, normal, options.seed, texel);
      });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the ambient occlusion of matches");
}

std::vector<float> matched_thickness(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                                     ThicknessMethod method, const ThicknessOptions& options) try {
  require_matches(surface, sites, matches);
  const sites::SitesData& data = internals(sites);
  const thickness::Walls walls(data, method, options.angle);
  std::vector<float> values = baking::no_values(matches, 1, "the thickness of matches");
  baking::for_each_rows(surface, options.progress, "thickness", [&](std::uint32_t begin, std::uint32_t end) {
    std::vector<std::uint32_t> texels;
    std::vector<thickness::WallStart> starts;
    for (std::uint32_t texel = begin; texel < end; ++texel) {
      const SurfacePoint point = matches.point(texel);
      if (point.face == kNone || !walls.measures(point.face)) continue;
      texels.push_back(texel);
      starts.push_back({point.face, baking::position_of(data.mesh, point)});
    }
    std::vector<thickness::WallEnd> ends(starts.size());
    thickness::WallSearch(walls).measure(method, starts, ends);
    for (std::size_t i = 0; i < texels.size(); ++i)
      if (ends[i].face != kNone) values[texels[i]] = static_cast<float>(ends[i].thickness);
  });
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the thickness of matches");
}

}  // namespace sdm

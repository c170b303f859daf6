#include "map/closest_measure.h"

#include <sdm/tolerance.h>

namespace sdm::map {

ClosestMeasure::ClosestMeasure(const Surface& surface, const Sites& sites, const MapOptions& options)
    : surface_(surface), engine_(engine_of(options)) {
  if (options.facing) {
    facing_.emplace(surface, sites, options);
    return;
  }
  description_.sign = choose_sign(sites, options);
  description_.measured = measured_distance(options);
  const SignMethod method = description_.sign.method;
  // Unsigned maps do without a pass over all faces.
  const double error =
      method == SignMethod::none ? 0 : engine_accuracy(engine_->info(), surface.mesh(), sites.mesh());
  inside_.emplace(internals(sites), method, error);
}

void ClosestMeasure::store(std::size_t first, std::span<const Vec3> points,
                           const sites::ClosestPacket& closest, TexelStore& texels) const {
  if (facing_) return store_matches(first, points, closest, texels);
  texels(first, closest, (*inside_)(points, closest));
}

void ClosestMeasure::store_matches(std::size_t first, std::span<const Vec3> points,
                                   const sites::ClosestPacket& closest, TexelStore& texels) const {
  const std::span<const std::uint32_t> faces = surface_.map_faces(),
                                       samples = surface_.sample_texels().subspan(first);
  sites::ClosestPacket matches = closest;
  std::uint32_t behind = 0, unmatched = 0;
  for (std::size_t i = 0; i < closest.count; ++i) {
    const ClosestPoint near = closest.get(i, points[i]);
    const Value value = facing_->value(points[i], facing_->normals[faces[samples[i]]], near);
    behind |= std::uint32_t{value.negative} << i;
    unmatched |= std::uint32_t{value.unmatched} << i;
    const ClosestPoint& found = value.closest;
    if (found.type != near.type || found.site != near.site) matches.set(i, points[i], found);
  }
  texels(first, matches, behind, unmatched);
}

}  // namespace sdm::map

#include "gpu/packed_samples.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "geometry/vec.h"
#include "gpu/finish.h"

namespace sdm::gpu {

std::vector<Sample> packed_samples(const surface::SurfaceData& surface, std::size_t first,
                                   std::size_t count) {
  std::vector<Sample> samples(count);
  parallel_for(count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t face = surface.sample_faces[first + i];
      const auto& [a, b, c] = surface.mesh.triangles[face];
      const Vec2 weights = surface.texel_weights(face, surface.samples[first + i]);
      samples[i] = {{a, b, c}, {static_cast<float>(weights[0]), static_cast<float>(weights[1])}};
    }
  });
  return samples;
}

PackedVertices packed_vertices(const UnitFrame& frame, std::span<const Vec3> at,
                               std::span<const std::uint8_t> used) {
  PackedVertices placed{.positions = std::vector<float>(3 * at.size())};
  for (std::size_t v = 0; v < at.size(); ++v) {
    if (used[v] == 0) continue;
    const Vec3 unit = frame.to_unit(at[v]);
    for (int k = 0; k < 3; ++k) {
      if (!(std::abs(unit[k]) <= kFar))
        throw Error(
            "O1 reaches too far from O2 for a map on the device, by more than 7 times its size: use an "
            "engine");
      placed.outermost = std::max(placed.outermost, std::abs(unit[k]));
      placed.positions[3 * v + k] = static_cast<float>(unit[k]);
    }
  }
  return placed;
}

}  // namespace sdm::gpu

// The samples and the vertices of a surface, as shaders/place_samples.wgsl reads them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/unit_frame.h"
#include "surface/surface_data.h"

namespace sdm::gpu {

/// A sample, as in shaders/place_samples.wgsl.
struct Sample {
  std::uint32_t vertices[3];
  float weights[2];  ///< of vertices 1 and 2; that of vertex 0 is what is left of 1
};

[[nodiscard]] std::vector<Sample> packed_samples(const surface::SurfaceData& surface, std::size_t first,
                                                 std::size_t count);

/// Vertices in a unit frame, three numbers each.
struct PackedVertices {
  std::vector<float> positions;
  double outermost = 1;  ///< the largest coordinate, or 1
};
/// Those of `used`, the others are 0. Throws sdm::Error for one that is too far away for single precision.
[[nodiscard]] PackedVertices packed_vertices(const UnitFrame& frame, std::span<const Vec3> at,
                                             std::span<const std::uint8_t> used);

}  // namespace sdm::gpu

// The domain of the rasteriser: a piece of a plane in space, mapped affinely to a piece of an image. A face
// of O1 in its atlas is one; a slice of a grid would be another.
#pragma once

#include <sdm/types.h>

#include "gl/polygons/convex_polygon.h"

namespace sdm::gl {

/// How far, in texels, polygons extend beyond the texel centres they are meant for: OpenGL guarantees corners
/// only to a grid of 1/16 texel, and the fragment shader makes the final decision.
inline constexpr double kMargin = 1.0 / 8;

/// (u, v) ↦ origin + (u − image_origin.u) edges[0] + (v − image_origin.v) edges[1], in texels.
struct PlanarDomain {
  std::uint32_t id = 0;  ///< of its texels in the rasteriser's tables
  Vec2 image_origin{};
  Vec3 origin{};
  std::array<Vec3, 2> edges{};
  ConvexPolygon outline;  ///< contains the centres of its texels, and everything drawn on it

  [[nodiscard]] Vec3 point(const Vec2& uv) const {
    const Vec2 d = uv - image_origin;
    return origin + d[0] * edges[0] + d[1] * edges[1];
  }
};

}  // namespace sdm::gl

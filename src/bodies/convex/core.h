// Convex cores: with a radius around them, they are the solids that have no faces.
#pragma once

#include <sdm/types.h>

#include <cstdint>

namespace sdm::solids {

enum class CoreKind : std::uint8_t {
  mesh,       ///< the convex hull of the vertices of the body's mesh
  axis,       ///< a segment of the axis z with a disc across it at each of its points
  half_space  ///< normal · x ≤ offset
};

/// The points of a solid are those within `radius` of its core: a sphere is a point, a capsule a segment, a
/// margin any core with a radius. In the frame of the body.
struct Core {
  CoreKind kind = CoreKind::mesh;
  double half_length = 0;  ///< of an axis: from −half_length to half_length along z
  double disc = 0;         ///< of an axis: the radius of the discs
  Vec3 normal{};           ///< of a half-space, of length 1
  double offset = 0;       ///< of a half-space
  double radius = 0;

  /// Whether it is a point or a segment, which has no inside.
  [[nodiscard]] bool thin() const { return kind == CoreKind::axis && disc == 0; }
};

/// How far from the origin half-spaces are compared with other bodies, which have coordinates up to that.
inline constexpr double kFarthest = 1e37;

/// The box around a core that is no mesh, with its radius.
[[nodiscard]] inline Box box_of(const Core& core) {
  if (core.kind == CoreKind::half_space)
    return {{-kFarthest, -kFarthest, -kFarthest}, {kFarthest, kFarthest, kFarthest}};
  const double across = core.disc + core.radius, along = core.half_length + core.radius;
  return {{-across, -across, -along}, {across, across, along}};
}

}  // namespace sdm::solids

// Where a line meets a triangle of any shape, including needles, segments and points.
#pragma once

#include <sdm/types.h>

#include <optional>

#include "geometry/triangle.h"

namespace sdm::core {

/// The parameters at which a line enters and leaves a triangle; equal unless it lies in the triangle's plane.
struct LineHit {
  double first, last;
};

/// The parameters t for which origin + t·direction lies in the closed triangle, or nothing if the line misses
/// it. `direction` must not be 0.
///
/// Whether the line meets the triangle, and the sign of the parameters, are exact for all finite coordinates:
/// a line meets at least one of the triangles around an edge or vertex that it passes through. The parameters
/// are rounded: the point they give is within 1e-11 of the distance between `origin` and the farthest corner.
/// Cost: about a hundred operations; big integers only where rounding could decide.
[[nodiscard]] std::optional<LineHit> line_meets_triangle(const Vec3& origin, const Vec3& direction,
                                                         const Corners& corners);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

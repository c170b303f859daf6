// A point, and the closest point of the other body.
#pragma once

#include "bodies/shape/body.h"

namespace sdm::contacts {

struct SurfacePoint {
  Vec3 at{};
  double distance = kInfinity;  ///< to the surface; negative inside
  Vec3 vector{};                ///< to the closest point
  ClosestPoint closest{};
  std::uint32_t face = kNone;  ///< a face of the closest site
};

/// Finds the closest point of the body. `likely_distance`: the surface is probably no farther away, which
/// makes the search shorter.
[[nodiscard]] SurfacePoint measure(const shape::Body& body, const Vec3& at, double likely_distance);

/// measure(), beginning with a face of the body that is probably close, or kNone.
[[nodiscard]] SurfacePoint measure_near(const shape::Body& body, const Vec3& at, std::uint32_t face);

/// Whether the closest point is on the boundary of the body, as it always is unless a solid intersects
/// itself.
[[nodiscard]] bool at_boundary(const shape::Body& body, const SurfacePoint& point);

}  // namespace sdm::contacts

// Rays and triangles in rational arithmetic: independent of the code under test.
#pragma once

#include <sdm/types.h>

#include <array>
#include <optional>

namespace sdm::oracle {

/// The least parameter t ≥ 0 at which origin + t·direction lies in the closed triangle, of any shape, rounded
/// to double; nothing if there is none. `last`: the largest.
struct RayInTriangle {
  double first, last;
};
[[nodiscard]] std::optional<RayInTriangle> ray_in_triangle(const Vec3& origin, const Vec3& direction,
                                                           const std::array<Vec3, 3>& corners);

}  // namespace sdm::oracle

// What is computed of the faces of A.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>

#include "geometry/triangle.h"
#include "geometry/vec.h"

namespace sdm::metrics {

struct FaceArea {
  double area = 0;
  double error = 0;  ///< of rounding, at most: that of a needle may be more than its area
};

[[nodiscard]] inline FaceArea area_of(const Corners& face) {
  constexpr double kAreaRounding = 1e-15;
  const auto& [p, q, r] = face;
  return {norm(cross(q - p, r - p)) / 2, kAreaRounding * norm(q - p) * norm(r - p)};
}

/// Zero of a face without area.
[[nodiscard]] inline Vec3 unit_normal(const Mesh& mesh, std::uint32_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  const Vec3 normal = cross(b - a, c - a);
  const double length = norm(normal);
  return length > 0 ? (1 / length) * normal : Vec3{};
}

}  // namespace sdm::metrics

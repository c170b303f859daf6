// A face as an affine frame, which moves along with it.
#pragma once

#include <sdm/mesh.h>

#include "geometry/vec.h"

namespace sdm::surface {

/// The point with weights (a, b), a, b ≥ 0, a + b ≤ 1, is origin + a edges[0] + b edges[1].
struct FaceFrame {
  Vec3 origin;
  std::array<Vec3, 2> edges;

  FaceFrame(const Mesh& mesh, std::size_t face) {
    const auto& [a, b, c] = mesh.triangles[face];
    origin = mesh.positions[a];
    edges = {mesh.positions[b] - origin, mesh.positions[c] - origin};
  }

  [[nodiscard]] Vec3 at(double a, double b) const { return origin + a * edges[0] + b * edges[1]; }

  /// Upper bound on the error of a point computed from weights rounded to float: at most 2⁻²⁵ per weight,
  /// plus a few roundings in double.
  [[nodiscard]] double rounding() const {
    double largest = 0;
    for (const Vec3& v : {origin, origin + edges[0], origin + edges[1]})
      for (const double x : v) largest = std::max(largest, std::abs(x));
    return 1e-14 * largest + 0x1.01p-25 * (norm(edges[0]) + norm(edges[1]));
  }
};

}  // namespace sdm::surface

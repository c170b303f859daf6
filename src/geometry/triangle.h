// Triangles by their corners.
#pragma once

#include <sdm/mesh.h>

#include <span>

namespace sdm::core {

using Corners = std::array<Vec3, 3>;

[[nodiscard]] inline Corners corners_of(std::span<const Vec3> positions, const Triangle& triangle) {
  return {positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]};
}
[[nodiscard]] inline Corners corners_of(const Mesh& mesh, std::size_t face) {
  return corners_of(mesh.positions, mesh.triangles[face]);
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

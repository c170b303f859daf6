// The interface to MikkTSpace, or to nothing in builds without it.
#pragma once

#include <array>
#include <span>

namespace sdm::baking {

/// What MikkTSpace reads and writes at a corner of a triangle.
struct MikkCorner {
  std::array<float, 3> position, normal;
  std::array<float, 2> uv;         ///< v up
  std::array<float, 4> tangent{};  ///< with the sign of the bitangent
};

[[nodiscard]] bool has_mikktspace();

/// Sets the tangents of the corners of triangles. Throws sdm::Error without MikkTSpace, std::bad_alloc if
/// there is not enough memory.
void set_tangents(std::span<std::array<MikkCorner, 3>> triangles);

}  // namespace sdm::baking

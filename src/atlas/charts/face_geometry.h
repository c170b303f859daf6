// Normals, areas and neighbours of faces, the input of charting.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <vector>

namespace sdm::atlas {

struct FaceGeometry {
  std::vector<Vec3> normal;  ///< unit; zero where the face has no area
  std::vector<double> area;  ///< 0 only where the face has none
  std::vector<Vec3> centroid;
  /// Across edge (v_k, v_k+1): the other face of an edge that has exactly two, else kNone.
  std::vector<std::array<std::uint32_t, 3>> neighbours;
};

/// Unit normal of a triangle, perpendicular to its longest edge up to rounding, even where the triangle is so
/// thin that its height is rounding noise: points of the triangle then lie in the plane through a corner with
/// this normal. Zero where the triangle has no area.
[[nodiscard]] Vec3 face_normal(const Vec3& a, const Vec3& b, const Vec3& c);

/// Cost: O(n log n), all cores.
[[nodiscard]] FaceGeometry face_geometry(const Mesh& mesh);

}  // namespace sdm::atlas

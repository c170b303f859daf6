/// Changes of a mesh's topology that keep the numbers of all that stays.
///
/// Threads: plain data; apply() may run concurrently on different meshes.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>

#include <cstdint>
#include <vector>

namespace sdm {

/// Vertices moved and added; faces removed, reconnected and added.
///
/// Numbers are stable. Vertices and faces keep theirs for good, and no number is used twice: added vertices
/// follow the present ones, added faces the present faces, both in the order of their lists. Vertices are
/// never removed; those of no face are ignored everywhere. A removed face keeps its place in Mesh::triangles
/// as (v, v, v), v its former first corner. Such a face has no sites, no texels and no area, and does not
/// count for bounds().
struct MeshEdit {
  /// A vertex and its new position.
  struct MovedVertex {
    std::uint32_t vertex;
    Vec3 position;
  };
  /// A face and its new vertices.
  struct ReconnectedFace {
    std::uint32_t face;
    Triangle triangle;  ///< its new corners; may refer to added vertices
  };

  std::vector<std::uint32_t> removed_faces{};
  /// Faces that stay but get other corners: to tear a mesh, faces on one side of the tear get copies of the
  /// vertices. A Surface keeps the triangle of the face in the atlas.
  std::vector<ReconnectedFace> reconnected_faces{};
  std::vector<MovedVertex> moved_vertices{};
  std::vector<Vec3> added_vertices{};
  std::vector<Triangle> added_faces{};  ///< may refer to added vertices
  /// Texture coordinates at the corners of the added faces, for meshes that have them; empty: zeros.
  std::vector<std::array<Vec2, 3>> added_corner_uvs{};
};

/// Whether a triangle is the place of a removed face: its three corners are one vertex.
[[nodiscard]] constexpr bool is_removed(const Triangle& triangle) {
  return triangle[0] == triangle[1] && triangle[1] == triangle[2];
}

/// Changes the mesh, which must be valid in the sense of validate(). Throws sdm::Error, and changes nothing,
/// if an index is out of range, if a face is removed or reconnected twice, or has been removed before, if a
/// new triangle has three equal corners, if there are texture coordinates for some added faces only or for a
/// mesh without any, if the result is not valid, or if there is not enough memory. Cost: by the size of the
/// edit, plus the bounds of the result, which take a pass over its faces.
SDM_API void apply(Mesh& mesh, const MeshEdit& edit);

}  // namespace sdm

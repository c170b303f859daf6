// The polygons of a file, and their conversion to a mesh.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <vector>

namespace sdm::io {

/// Polygons over shared vertices, as stored in a file; unchecked.
struct PolygonMesh {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<std::uint32_t> corners;     ///< the vertex of each corner, polygon after polygon
  std::vector<std::uint32_t> corner_uvs;  ///< the uv of each corner, or kNone; may be empty
  std::vector<std::uint32_t> ends;        ///< for each polygon, one past its last corner

  /// Ends a polygon of the corners added since the last one. Polygons of fewer than three corners are
  /// dropped.
  void end_polygon();
};

/// Welds vertices whose positions are bit-identical (−0 equals 0), drops vertices without a face, and
/// triangulates. Texture coordinates are kept if every corner has finite ones. Throws sdm::Error if an index
/// is out of range, a coordinate is not finite, or there are no faces.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons);

/// As above. Also returns the index in the mesh of each vertex, or kNone if it was dropped. The mesh's
/// vertices are in the order of their first occurrence in the file.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons, std::vector<std::uint32_t>& renumbered);

}  // namespace sdm::io

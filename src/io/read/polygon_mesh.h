// What the readers make of a file, and the mesh it becomes.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <vector>

namespace sdm::io {

/// Polygons over shared vertices, as they stand in a file; nothing in it is checked.
struct PolygonMesh {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<std::uint32_t> corners;     ///< the vertex of each corner, polygon after polygon
  std::vector<std::uint32_t> corner_uvs;  ///< the uv of each corner, or kNone; empty, or one a corner
  std::vector<std::uint32_t> ends;        ///< for each polygon, one past its last corner

  /// Ends the polygon of the corners that came since the last one; fewer than three are dropped.
  void end_polygon();
};

/// Welds vertices whose positions are bit-identical (−0 equals 0), drops those of no face, and triangulates.
/// Texture coordinates are kept where every corner has finite ones. Throws sdm::Error for an index out of
/// range and where there is no face.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons);

/// The same; tells what became of each vertex: its number in the mesh, where vertices keep the order in which
/// they are met first, or kNone for one that was dropped.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons, std::vector<std::uint32_t>& renumbered);

}  // namespace sdm::io

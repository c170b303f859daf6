// The polygons of a file, and their conversion to a mesh.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/polygons/polygon_attributes.h"
#include "io/mesh/polygons/polygon_materials.h"

namespace sdm::io {

/// Names of polygons: each holds from one polygon on, until another one does.
class PolygonNames {
 public:
  struct Run {
    std::uint32_t first_polygon, name;  ///< index into names(), or kNone for an empty one
  };

  void begin(std::size_t polygon, std::string_view name);
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }  ///< each once
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }            ///< by polygon

 private:
  std::vector<std::string> names_;
  std::map<std::string, std::uint32_t, std::less<>> index_;
  std::vector<Run> runs_;
};

/// Polygons over shared vertices, as stored in a file; unchecked.
struct PolygonMesh {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<std::uint32_t> corners;     ///< the vertex of each corner, polygon after polygon
  std::vector<std::uint32_t> corner_uvs;  ///< the uv of each corner, or kNone; may be empty
  std::vector<std::uint32_t> ends;        ///< for each polygon, one past its last corner
  /// The body of each vertex: only vertices of one body are welded. Empty: all are of one.
  std::vector<std::uint32_t> bodies;
  PolygonNames objects, groups, materials, faces, colors;
  std::vector<PolygonAttribute> attributes;  ///< if asked for
  PolygonMaterials surfaces;                 ///< if asked for
  std::optional<Tessellation> tessellation;  ///< of CAD
  std::vector<std::string> notes;            ///< what was left out, or may be wrong; see MeshFile::notes

  /// Ends a polygon of the corners added since the last one. Polygons of fewer than three corners are
  /// dropped.
  void end_polygon();
};

/// Welds vertices of a body whose positions are bit-identical (−0 equals 0), drops vertices without a face,
/// and triangulates. Texture coordinates are kept if every corner has finite ones; see uv_fault(). Throws
/// sdm::Error if an index is out of range, a coordinate is not finite, or there are no faces.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons);

/// Returns why the mesh has no texture coordinates although the file has some, naming the first face at
/// fault; empty if it has them, or the file has none. Cost: linear.
[[nodiscard]] std::string uv_fault(const PolygonMesh& polygons);

/// As above. Also returns the index in the mesh of each vertex, or kNone if it was dropped. The mesh's
/// vertices are in the order of their first occurrence in the file.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons, std::vector<std::uint32_t>& renumbered);

/// As above. Also sets, for each polygon, one past its last triangle in the mesh, and `places`, unless null,
/// to the indices in PolygonMesh::corners of each triangle's corners.
[[nodiscard]] Mesh to_mesh(const PolygonMesh& polygons, std::vector<std::uint32_t>& renumbered,
                           std::vector<std::uint32_t>& triangle_ends,
                           std::vector<Triangle>* places = nullptr);

}  // namespace sdm::io

// The meshes of consecutive files, as one mesh that is edited.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_files.h>

#include <cstdint>
#include <span>
#include <vector>

#include "io/mesh/frames/match_polygons.h"
#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Follows files whose vertices and faces may differ, with stable numbers for what stays: see MeshSequence.
class ChangingMesh {
 public:
  /// Throws sdm::Error as to_mesh and validate do.
  explicit ChangingMesh(PolygonMesh polygons);

  /// Moves on to another file. Throws sdm::Error, and changes nothing, as to_mesh and validate do. Cost:
  /// linear if the faces of the file are the same; otherwise O(n log n) in those at other places of its list.
  void follow(PolygonMesh polygons);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// What the last call of follow() changed.
  [[nodiscard]] const TopologyChange& change() const { return change_; }

 private:
  /// A triangle of a polygon.
  struct Face {
    std::uint32_t number;  ///< in mesh_; kNone while its three corners are one vertex
    Triangle places;       ///< of its corners, in the polygon
  };
  struct Faces {
    std::vector<Face> faces;          ///< of all polygons
    std::vector<std::uint32_t> ends;  ///< for each polygon, one past its last face
    [[nodiscard]] std::span<const Face> of(std::uint32_t polygon) const;
  };
  struct NextFile;
  class EditToNext;

  void start(NextFile next);
  [[nodiscard]] bool move(const PolygonMesh& polygons);
  void keep_welded(PolygonMesh& polygons) const;
  void match(NextFile& next, bool numbers_stay) const;

  PolygonCycles cycles_;               // the polygons of the file
  std::vector<std::uint32_t> vertex_;  // the vertex of mesh_ of each vertex of the file, or kNone
  Faces faces_;
  double weld_tolerance_ = 0;  // vertices that were one stay one up to this distance
  Mesh mesh_;
  TopologyChange change_;
};

}  // namespace sdm::io

// The meshes of consecutive files, as one mesh that is edited.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_files.h>
#include <sdm/types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Polygons as cycles of vertex numbers; kNone for a vertex that equals no other.
struct PolygonCycles {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> ends;  ///< for each polygon, one past its last corner

  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t polygon) const {
    const std::uint32_t begin = polygon == 0 ? 0 : ends[polygon - 1];
    return {corners.data() + begin, ends[polygon] - begin};
  }
};

/// The polygon of the earlier file that a polygon is.
struct PolygonMatch {
  std::uint32_t polygon = kNone;  ///< none
  std::uint32_t shift = 0;        ///< its corner i is corner (i + shift) mod n of the later polygon
};

/// Matches polygons with the same cycle of numbers, from whichever corner it starts: those at the same place
/// in both lists first, then the others, equal ones in the order of the lists. Adds to `matches`, one for
/// each polygon of `now`, whose present entries stay; each polygon of `before` is matched once at most. Cost:
/// linear for polygons at the same place, O(n log n) for the others.
void match_polygons(const PolygonCycles& before, const PolygonCycles& now,
                    std::vector<PolygonMatch>& matches);

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

// Meshes as meshoptimizer takes and returns them.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "simplify/poles.h"

namespace sdm::simplify {

/// The vertices of a mesh, welded: one for each position and, on seams, for each of its texture coordinates.
/// The simplifier knows the positions as float, in units of `size` from the centre of the box.
struct Wedges {
  std::vector<Vec3> positions;        ///< of distinct vertices, in the order of the mesh
  std::vector<std::uint32_t> vertex;  ///< the position of each wedge
  std::vector<Vec2> uvs;              ///< of each wedge but poles; empty: none
  Poles poles;
  std::vector<std::uint32_t> regions;        ///< of each wedge, a face of the input in its region; or empty
  std::vector<std::array<float, 3>> points;  ///< of each wedge
  std::vector<Triangle> triangles;           ///< of wedges; none repeats a position
  /// How the faces of the chart of each wedge that has texture coordinates wind in the texture; a chart is
  /// what wedges connect: 1 or −1; 0: both ways, or none has an area there.
  std::vector<std::int8_t> turns;
  std::vector<Triangle> flat;  ///< those without an area in the texture; ascending
  double size = 1;             ///< the diagonal of the box
};

/// `mesh` is valid. `regions`: of each of its faces, a face of the input in the same region; or empty. Cost:
/// linear.
[[nodiscard]] Wedges wedges_of(const Mesh& mesh, std::span<const std::uint32_t> regions);

/// The texture coordinates of a triangle of wedges that have some.
[[nodiscard]] std::array<Vec2, 3> uvs_of(const Wedges& wedges, const Triangle& triangle);

/// The mesh of some triangles of wedges, and what Simplified::source_faces is of it.
struct MeshOfWedges {
  Mesh mesh;
  std::vector<std::uint32_t> source_faces;
};
/// `single_precision`: positions are rounded to float.
[[nodiscard]] MeshOfWedges mesh_of(const Wedges& wedges, std::span<const Triangle> triangles,
                                   bool single_precision);

/// The point with coordinates rounded to float, as files in single precision have it.
[[nodiscard]] Vec3 rounded_to_float(const Vec3& p);

}  // namespace sdm::simplify

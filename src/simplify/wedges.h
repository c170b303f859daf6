// Meshes as meshoptimizer takes and returns them.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::simplify {

/// The vertices of a mesh, welded: one for each position and, on seams, for each of its texture coordinates.
/// The simplifier knows the positions as float, in units of `size` from the centre of the box.
struct Wedges {
  std::vector<Vec3> positions;               ///< of distinct vertices, in the order of the mesh
  std::vector<std::uint32_t> vertex;         ///< the position of each wedge
  std::vector<Vec2> uvs;                     ///< of each wedge; empty: none
  std::vector<std::array<float, 3>> points;  ///< of each wedge
  std::vector<Triangle> triangles;           ///< of wedges; none repeats a position
  double size = 1;                           ///< the diagonal of the box
};

/// `mesh` is valid. Cost: linear.
[[nodiscard]] Wedges wedges_of(const Mesh& mesh);

/// The mesh of some triangles of wedges. `single_precision`: positions are rounded to float.
[[nodiscard]] Mesh mesh_of(const Wedges& wedges, std::span<const Triangle> triangles, bool single_precision);

}  // namespace sdm::simplify

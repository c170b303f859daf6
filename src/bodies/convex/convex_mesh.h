// A mesh that bounds a convex solid, for searches by support functions.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/arrays/rows.h"
#include "sites/sites_data.h"

namespace sdm::convex {

/// An edge of the mesh from one of its vertices: the other end, a number in the ConvexMesh, and its two
/// faces.
struct Spoke {
  std::uint32_t end = 0;
  std::array<std::uint32_t, 2> faces{};

  [[nodiscard]] std::uint32_t first_face() const { return faces[0] < faces[1] ? faces[0] : faces[1]; }
};

/// The vertices and edges of a convex solid, in the frame of the mesh. Vertices have numbers of their own:
/// those of no face are left out.
struct ConvexMesh {
  static constexpr std::size_t kBlock = 16;  ///< vertices are compared in multiples of so many

  std::array<std::vector<float>, 3>
      along;  ///< coordinates about the centre, those of a vertex repeated at the end
  std::vector<Vec3> points;
  std::vector<std::uint32_t> vertex;  ///< the number of each in the mesh
  std::vector<Vec3> normals;          ///< of the faces, to rounding, outwards
  /// Normals times the size over the distance of the plane from the centre, of each plane that has faces;
  /// empty if the normal of a face is not reliable.
  std::array<std::vector<float>, 3> planes;
  core::CompressedRows<Spoke> spokes;     ///< of each vertex
  std::vector<std::uint32_t> first_face;  ///< the smallest number of a face, of each vertex
  int outward = 1;                        ///< −1 if the mesh is inside out
  Vec3 centre{};                          ///< below the planes of all faces
  double inner_radius = 0;                ///< at most the distance of the centre from the planes of the faces
  double size = 0;                        ///< the diagonal of the box
  double lengths = 0;                     ///< the size and the distance of the centre from the origin
  double height_error = 0;                ///< of the height of a vertex that is farthest along a unit vector
  bool climbs = false;     ///< whether farthest vertices are found by neighbours, too, with that error
  double least_climb = 0;  ///< heights of neighbours that differ by less are equal
  /// Of large meshes that climb, some vertices to begin at, as in `along`, and their numbers; otherwise
  /// empty.
  std::array<std::vector<float>, 3> coarse;
  std::vector<std::uint32_t> coarse_vertex;
};

/// Whether the mesh is the boundary of a convex solid, which is decided exactly: closed, oriented
/// consistently, in one piece, no edge is reflex, all faces have an area and are seen from the inside by some
/// point, and the solid angles of faces from there add up to one sphere: the surface is then that of a star
/// without reflex edges. False for meshes of more than kMostVertices. Cost: linear; of other meshes, that of
/// the edges up to the first reflex one. Allocates nothing.
[[nodiscard]] bool is_convex(const sites::SitesData& sites);

/// The mesh, if is_convex(). Null for other meshes.
[[nodiscard]] std::unique_ptr<const ConvexMesh> recognise(const sites::SitesData& sites);

/// All vertices are compared in each direction: those of larger meshes would take longer than a search of the
/// tree.
inline constexpr std::size_t kMostVertices = 8192;

}  // namespace sdm::convex

/// Triangle meshes: any triangle soup, open or closed, manifold or not.
///
/// Threads: a Mesh is a plain value; the functions may be called concurrently, also with the same mesh.
#pragma once

#include <sdm/api.h>
#include <sdm/names.h>
#include <sdm/types.h>

#include <cstddef>
#include <tuple>
#include <vector>

namespace sdm {

/// A triangle soup with shared vertices.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  /// Texture coordinates of each triangle's three corners, (0, 0) at the lower left of the image; empty, or
  /// one entry per triangle.
  std::vector<std::array<Vec2, 3>> corner_uvs;
};

/// Throws sdm::Error unless the mesh can be used: every index in range, every coordinate finite and at most
/// 1e37 in magnitude, the extent of the mesh above 1e-30, at most 2^30 triangles, at least one of them with
/// an area, and texture coordinates finite and present for all triangles or none. Cost: linear.
SDM_API void validate(const Mesh& mesh);

/// Returns the bounding box of all vertices that triangles use; removed faces (see MeshEdit) use none. Cost:
/// linear.
[[nodiscard]] SDM_API Box bounds(const Mesh& mesh);

/// Counts and topology of a mesh, as printed by `sdm info`.
struct MeshInfo {
  std::size_t vertices = 0, triangles = 0, edges = 0;
  Box bounds;
  std::size_t components = 0;            ///< sets of faces connected by shared vertices
  std::size_t boundary_edges = 0;        ///< edges of exactly one face
  std::size_t nonmanifold_edges = 0;     ///< edges of three faces or more
  std::size_t nonmanifold_vertices = 0;  ///< vertices whose faces do not form one fan
  std::size_t degenerate_faces = 0;      ///< faces of zero area, repeated corners included
  std::size_t duplicate_faces = 0;       ///< faces with the same three vertices as an earlier face
  std::size_t unused_vertices = 0;       ///< vertices of no face
  bool closed = false;                   ///< no boundary edge and no non-manifold edge
  bool orientable = false;               ///< the faces can be oriented consistently
  bool oriented = false;                 ///< the faces are oriented consistently
  bool manifold = false;                 ///< no non-manifold edge or vertex
  bool has_uvs = false;
  double area = 0;
};

template <>
inline constexpr std::tuple kFields<MeshInfo>{
    Field{"vertices", &MeshInfo::vertices, "The number of vertices."},
    Field{"edges", &MeshInfo::edges, "The number of edges."},
    Field{"triangles", &MeshInfo::triangles, "The number of triangles."},
    Field{"bounds", &MeshInfo::bounds, "The box of the vertices."},
    Field{"components", &MeshInfo::components, "Sets of faces that are connected by shared vertices."},
    Field{"closed", &MeshInfo::closed, "There is no boundary edge and no non-manifold edge."},
    Field{"orientable", &MeshInfo::orientable, "The faces can be oriented consistently."},
    Field{"oriented", &MeshInfo::oriented, "The faces are oriented consistently."},
    Field{"manifold", &MeshInfo::manifold, "There is no non-manifold edge or vertex."},
    Field{"boundary_edges", &MeshInfo::boundary_edges, "Edges of exactly one face."},
    Field{"nonmanifold_edges", &MeshInfo::nonmanifold_edges, "Edges of three faces or more."},
    Field{"nonmanifold_vertices", &MeshInfo::nonmanifold_vertices,
          "Vertices whose faces do not form one fan."},
    Field{"degenerate_faces", &MeshInfo::degenerate_faces, "Faces without area, repeated corners included."},
    Field{"duplicate_faces", &MeshInfo::duplicate_faces,
          "Faces with the same three vertices as an earlier face."},
    Field{"unused_vertices", &MeshInfo::unused_vertices, "Vertices of no face."},
    Field{"uvs", &MeshInfo::has_uvs, "There are texture coordinates."},
    Field{"area", &MeshInfo::area, "The area of the surface."}};

/// Computes the counts and the topology of a mesh. Duplicate faces, and degenerate faces with repeated
/// corners, do not count as incident to edges. Cost: O(n log n).
[[nodiscard]] SDM_API MeshInfo inspect(const Mesh& mesh);

}  // namespace sdm

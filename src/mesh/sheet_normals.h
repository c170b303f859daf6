// Normals of the smooth sheets of faces at vertices.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>

#include <cstdint>
#include <vector>

namespace sdm::mesh {

/// One normal for each smooth sheet of faces at a vertex: faces whose normals differ by more than a crease
/// from the first face of a sheet are of another one. A normal is the mean of its faces', weighted by their
/// angles at the vertex.
struct SheetNormals {
  std::vector<Vec3f> normals;         ///< unit vectors
  std::vector<std::uint32_t> vertex;  ///< the vertex of each normal
  std::vector<Triangle> corner;       ///< the normal of each corner of each face
};

/// `crease`: the cosine of its angle; −2 joins all faces. Removed faces have no normals (kNone). Faces
/// without area take the normals of others, or (0, 0, 1). Cost: linear.
[[nodiscard]] SheetNormals sheet_normals(const Mesh& mesh, double crease);

/// Those of an attribute of three components: a sheet is formed by the corners at a vertex that share a row.
/// It fits the mesh, and each corner of a face that is not removed has a row. Cost: linear.
[[nodiscard]] SheetNormals sheet_normals(const Mesh& mesh, const MeshAttribute& normals);

}  // namespace sdm::mesh

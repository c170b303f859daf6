// The vertices of a drawn model of a surface.
#pragma once

#include <sdm/mesh_attributes.h>
#include <sdm/surface.h>

#include <cstdint>
#include <span>
#include <vector>

#include "io/mesh/model/shading_normals.h"

namespace sdm::io {

/// One vertex for each normal, each position in the atlas and each tangent of each vertex of the mesh, since
/// renderers have one index for all attributes.
struct ModelVertices {
  std::vector<std::uint32_t> normal;   ///< into ShadingNormals, which also has the vertex of the mesh
  std::vector<Vec2> place;             ///< atlas coordinates, in texels
  std::vector<std::uint32_t> tangent;  ///< the row of each one's tangent; empty without tangents
  std::vector<Triangle> triangles;     ///< of these vertices, in the order of the faces
};

/// The faces whose corners are not the same vertex, which the validator of glTF reports.
[[nodiscard]] std::vector<std::uint32_t> drawn_faces(const Mesh& mesh);

/// The vertices of some faces of the surface, in the order of their first use. `tangents`: null, or the
/// tangents() of the surface. Cost: linear.
[[nodiscard]] ModelVertices model_vertices(const Surface& surface, const ShadingNormals& normals,
                                           std::span<const std::uint32_t> faces,
                                           const MeshAttribute* tangents = nullptr);

}  // namespace sdm::io

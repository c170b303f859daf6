// The attributes of a mesh, from those of a file's polygons.
#pragma once

#include <sdm/mesh_attributes.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Takes the attributes of the polygons, with the rows of each triangle's corners; those that do not cover
/// all polygons are left out, with a note. Texture coordinates that only some corners have are `uv0`.
/// `places`, `triangle_ends`: as of to_mesh().
[[nodiscard]] std::vector<MeshAttribute> to_attributes(PolygonMesh& polygons,
                                                       const std::vector<Triangle>& places,
                                                       const std::vector<std::uint32_t>& triangle_ends,
                                                       std::vector<std::string>& notes);

/// Returns the material of each triangle. `triangle_ends`: as of to_mesh().
[[nodiscard]] std::vector<std::uint32_t> materials_of_triangles(
    const PolygonMaterials& materials, const std::vector<std::uint32_t>& triangle_ends);

}  // namespace sdm::io

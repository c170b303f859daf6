// Normals for drawing a mesh.
#pragma once

#include <sdm/mesh_attributes.h>

#include <cmath>
#include <numbers>

#include "mesh/sheet_normals.h"

namespace sdm::io {

using ShadingNormals = mesh::SheetNormals;

/// The normals of sheets that end at creases of kDrawnCrease.
[[nodiscard]] inline ShadingNormals shading_normals(const Mesh& mesh) {
  return mesh::sheet_normals(mesh, std::cos(kDrawnCrease * std::numbers::pi / 180));
}

}  // namespace sdm::io

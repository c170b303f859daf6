// Normals for drawing a mesh.
#pragma once

#include "mesh/sheet_normals.h"

namespace sdm::io {

using ShadingNormals = mesh::SheetNormals;

/// The normals of sheets that end at creases of 40°.
[[nodiscard]] inline ShadingNormals shading_normals(const Mesh& mesh) {
  constexpr double kCrease = 0.766;  // the cosine of 40°
  return mesh::sheet_normals(mesh, kCrease);
}

}  // namespace sdm::io

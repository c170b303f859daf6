// Normals for drawing a mesh.
#pragma once

#include <sdm/mesh_attributes.h>
#include <sdm/surface.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "mesh/sheet_normals.h"
#include "surface/surface_data.h"

namespace sdm::io {

using ShadingNormals = mesh::SheetNormals;

/// The normals of sheets that end at creases of kDrawnCrease.
[[nodiscard]] inline ShadingNormals shading_normals(const Mesh& mesh) {
  return mesh::sheet_normals(mesh, std::cos(kDrawnCrease * std::numbers::pi / 180));
}
/// Those of O1, which are kept with it: views, models and pages need them.
[[nodiscard]] inline const ShadingNormals& shading_normals(const Surface& surface) {
  return internals(surface).drawn_normals.get(
      [&] { return std::make_shared<ShadingNormals>(shading_normals(surface.mesh())); });
}

}  // namespace sdm::io

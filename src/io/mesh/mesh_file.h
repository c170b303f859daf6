// What is kept of the polygons of a mesh file.
#pragma once

#include <sdm/mesh_files.h>

#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Returns the mesh of the polygons, triangulated and welded, with what the options ask for; without the
/// checksum of the file. Throws sdm::Error if the mesh is unusable; the message does not name the file.
[[nodiscard]] MeshFile to_mesh_file(PolygonMesh polygons, const MeshFileOptions& options);

}  // namespace sdm::io

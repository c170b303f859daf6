// Meshes as GLB models.
#pragma once

#include <sdm/mesh_files.h>

#include <ostream>

namespace sdm::io {

/// Writes a binary glTF model: a mesh of each object, with a primitive for each of its materials.
void write_model(std::ostream& out, const Mesh& mesh, const MeshExtras& extras);

}  // namespace sdm::io

// OBJ files, with their materials.
#pragma once

#include <sdm/mesh_files.h>

#include <filesystem>

namespace sdm::io {

/// Writes the faces with all digits that the numbers have, so that they are read as they were, and, unless
/// there is a library already, the materials and their pictures beside the file.
void write_obj(const std::filesystem::path& file, const Mesh& mesh, const MeshExtras& extras);

}  // namespace sdm::io

// PLY files.
#pragma once

#include <sdm/mesh_files.h>

#include <ostream>

namespace sdm::io {

/// Writes binary PLY: positions and texture coordinates of corners in double precision, normals as float,
/// colours in 8 bits, in sRGB. Where normals or colours of corners differ, there are several vertices.
void write_ply(std::ostream& out, const Mesh& mesh, const MeshExtras& extras);

}  // namespace sdm::io

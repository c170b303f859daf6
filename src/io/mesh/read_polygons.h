// The polygons of a mesh file of any format.
#pragma once

#include <sdm/mesh.h>

#include <filesystem>
#include <string_view>

#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Returns whether files with this extension, such as ".obj", in any case, are mesh files.
[[nodiscard]] bool is_mesh_extension(std::string_view extension);

/// Returns whether a mesh file is glTF, from the contents, or else from the file name's extension.
[[nodiscard]] bool is_gltf(std::string_view bytes, const std::filesystem::path& file);

/// Returns the names of the format of a mesh file that begins with these bytes; empty if the content shows
/// none. Binary STL is recognised by all of its bytes only.
[[nodiscard]] std::string_view mesh_format_of(std::string_view begin);

/// What is read of a mesh file.
struct PolygonOptions {
  TessellationOptions tessellation{};  ///< of CAD
  bool attributes = false;             ///< PolygonMesh::attributes
};

/// Reads the contents of a mesh file. Throws sdm::Error; the message does not name the file.
[[nodiscard]] PolygonMesh read_polygons(std::string_view bytes, const std::filesystem::path& file,
                                        const PolygonOptions& options = {});

}  // namespace sdm::io

// One reader for each format. All throw sdm::Error that names the fault and its place, not the file.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/read/polygon_mesh.h"

namespace sdm::io {

/// Wavefront OBJ: v, vt and f statements (polygons, indices from 1 or relative); all others are skipped.
[[nodiscard]] PolygonMesh read_obj(std::string_view text);

/// PLY, text or binary of either byte order: any element and property may be there; vertex (x, y, z, and
/// texture coordinates), face (vertex_indices, and texcoord) and tristrips are read.
[[nodiscard]] PolygonMesh read_ply(std::string_view bytes);

/// STL, text or binary. Normals and attributes are skipped.
[[nodiscard]] PolygonMesh read_stl_text(std::string_view text);
[[nodiscard]] PolygonMesh read_stl_binary(std::string_view bytes);
/// Whether a binary STL file of this size says that it holds as many triangles as it does.
[[nodiscard]] bool is_stl_binary(std::string_view bytes);

/// Geomview OFF as text, with any of the prefixes ST, C and N.
[[nodiscard]] PolygonMesh read_off(std::string_view text);
/// Whether `word` is the header of any kind of OFF.
[[nodiscard]] bool is_off_header(std::string_view word);

/// glTF 2.0, as JSON or GLB: the triangles of all meshes of the default scene, in its coordinates. `file`
/// tells where buffers outside of it lie.
[[nodiscard]] PolygonMesh read_gltf(std::string_view bytes, const std::filesystem::path& file);

/// Autodesk 3DS: all meshes. They are stored in the coordinates of the scene; its axes are kept.
[[nodiscard]] PolygonMesh read_3ds(std::string_view bytes);

}  // namespace sdm::io

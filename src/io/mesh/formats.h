// One reader for each format. All throw sdm::Error; the message describes the fault and its position, but
// does not name the file.
#pragma once

#include <sdm/mesh.h>

#include <filesystem>
#include <string_view>

#include "io/mesh/polygons/polygon_mesh.h"

namespace sdm::io {

/// Reads Wavefront OBJ: v, vt and f statements (polygons; indices are relative or count from 1), and names of
/// faces by o, g and usemtl. Texture coordinates of an index out of range are left out, all of them, with a
/// note. `attributes`: also vn, colours after the coordinates of v,
/// and the materials of mtllib, looked up relative to `file`. All other statements are skipped.
[[nodiscard]] PolygonMesh read_obj(std::string_view text, const std::filesystem::path& file,
                                   bool attributes = false);

/// Reads PLY, as text or binary of either byte order: the elements vertex (x, y, z, texture coordinates),
/// face (vertex_indices, texcoord) and tristrips; `attributes`: all other numbers of vertices and faces,
/// lists excepted. All other elements and properties are skipped. Names of properties may be in upper case.
[[nodiscard]] PolygonMesh read_ply(std::string_view bytes, bool attributes = false);

/// Reads STL, as text or binary; the solids of text are objects. Normals and attributes are skipped. Text is
/// read by words, wherever its lines end; endsolid may be missing, with a note. A count in a binary header
/// that is too low, or unknown (0 or 2^32 − 1), gives way to the size of the file, with a note.
[[nodiscard]] PolygonMesh read_stl_text(std::string_view text);
[[nodiscard]] PolygonMesh read_stl_binary(std::string_view bytes);
/// Returns whether the data begin with the header of a binary STL file and have the size that it implies.
[[nodiscard]] bool is_stl_binary(std::string_view bytes);

/// Reads Geomview OFF as text, with any of the prefixes ST, C, N and 4 (homogeneous coordinates), and nOFF of
/// three dimensions.
[[nodiscard]] PolygonMesh read_off(std::string_view text);
/// Returns whether `word` is the header of any variant of OFF.
[[nodiscard]] bool is_off_header(std::string_view word);

/// Reads glTF 2.0, as JSON or GLB: the triangles of all meshes of the default scene, in scene coordinates.
/// External buffers are looked up relative to `file`. `attributes`: also those of vertices, tangents, joints
/// and weights excepted, and materials.
[[nodiscard]] PolygonMesh read_gltf(std::string_view bytes, const std::filesystem::path& file,
                                    bool attributes = false);

/// Reads Autodesk 3DS: all meshes, in the coordinates of the scene, as they are stored.
[[nodiscard]] PolygonMesh read_3ds(std::string_view bytes);

/// Reads STEP (ISO 10303-21) and IGES as text: the faces of all solids, shells and surfaces, in millimetres,
/// assemblies with their instances, with the names and colours of faces. Faces that share an edge share the
/// vertices on it. Also throws sdm::Error where the module that has OpenCASCADE is not installed.
[[nodiscard]] PolygonMesh read_step(std::string_view bytes, const std::filesystem::path& file,
                                    const TessellationOptions& options);
[[nodiscard]] PolygonMesh read_iges(std::string_view bytes, const std::filesystem::path& file,
                                    const TessellationOptions& options);
/// Returns false where these two only throw: messages do not name them among the formats.
[[nodiscard]] bool reads_cad();
/// Returns whether the data begin as STEP, or as IGES: its first line has the letter S in column 73.
[[nodiscard]] bool is_step(std::string_view bytes);
[[nodiscard]] bool is_iges(std::string_view bytes);

}  // namespace sdm::io

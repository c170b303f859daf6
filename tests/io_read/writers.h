// Mesh files, built in memory and read through a real file.
#pragma once

#include <sdm/mesh.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace sdm::test {

/// Writes `contents` to a file of this name in a folder of the test's own; returns its path.
std::filesystem::path write_file(const std::string& name, std::string_view contents);

/// read_mesh of a file with these contents.
Mesh read_as(const std::string& name, std::string_view contents);

/// What read_mesh throws for a file with these contents, without the path; empty if it throws nothing.
std::string fault_of(const std::string& name, std::string_view contents);

/// Appends the bytes of a number.
template <typename T>
void put(std::string& out, T value, std::endian order = std::endian::little) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (order != std::endian::native) std::reverse(raw, raw + sizeof(T));
  out.append(raw, sizeof(T));
}

/// A number as text that reads back to the bit.
std::string text(double value);

// Plain files of each format. Texture coordinates are written where the mesh has them and the format can:
// OBJ, PLY (texcoord a face), glTF and 3DS (vertices are repeated a corner).
std::string obj(const Mesh& mesh);
std::string off(const Mesh& mesh);
std::string stl_text(const Mesh& mesh);
std::string stl_binary(const Mesh& mesh);
std::string ply_text(const Mesh& mesh);
std::string ply_binary(const Mesh& mesh, std::endian order);
std::string tds(const Mesh& mesh);
/// `nodes`: the JSON list of nodes, which use mesh 0; `buffer_uri`: the members that say where the buffer is.
/// Its bytes are those of gltf_buffer.
std::string gltf_json(const Mesh& mesh, const std::string& nodes, const std::string& buffer_uri);
std::string gltf_buffer(const Mesh& mesh);
std::string glb(std::string json, std::string buffer);
std::string glb(const Mesh& mesh);
std::string base64(std::string_view bytes);

/// Every corner of every triangle in turn: the same for two meshes that differ in numbering only.
std::vector<Vec3> corner_positions(const Mesh& mesh);

}  // namespace sdm::test

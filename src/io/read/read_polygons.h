// Any mesh file's polygons.
#pragma once

#include <sdm/error.h>

#include <filesystem>
#include <new>
#include <string>
#include <string_view>

#include "io/read/polygon_mesh.h"

namespace sdm::io {

enum class MeshFormat { unknown, obj, ply, stl_text, stl_binary, off, gltf, tds };

/// Told by the contents, else by the extension of the file's name.
[[nodiscard]] MeshFormat format_of(std::string_view bytes, const std::filesystem::path& file);

/// Reads the contents of a mesh file. Throws sdm::Error that names the fault, not the file.
[[nodiscard]] PolygonMesh read_polygons(std::string_view bytes, const std::filesystem::path& file);

/// Calls `read`; an sdm::Error of it, or want of memory, becomes one that begins with `name`, if that is
/// not empty.
template <typename Read>
auto with_error_prefix(const std::string& name, const Read& read) {
  const std::string prefix = name.empty() ? "" : name + ": ";
  try {
    return read();
  } catch (const Error& fault) {
    throw Error(prefix + fault.what());
  } catch (const std::bad_alloc&) {
    throw Error(prefix + "there is not enough memory to read it");
  }
}

}  // namespace sdm::io

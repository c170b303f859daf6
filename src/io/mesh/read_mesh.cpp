#include <sdm/mesh_files.h>

#include <new>
#include <span>
#include <utility>

#include "core/checksum.h"
#include "core/memory.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/read_polygons.h"

namespace sdm {

Mesh read_mesh(const std::filesystem::path& file) try {
  return io::with_error_prefix(file.string(), [&] {
    Mesh mesh = io::to_mesh(io::read_polygons(io::read_bytes(file).view(), file));
    validate(mesh);
    return mesh;
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("the name of a mesh file");
}

MeshFile read_mesh_file(const std::filesystem::path& file, const MeshFileOptions& options) try {
  return io::with_error_prefix(file.string(), [&] {
    io::FileBytes bytes = io::read_bytes(file);
    io::PolygonMesh polygons =
        io::read_polygons(bytes.view(), file, {options.tessellation, options.attributes});
    core::Checksum checksum;
    checksum.add(std::span<const char>(bytes.view()));
    bytes = {};  // their memory is needed below
    MeshFile result = io::to_mesh_file(std::move(polygons), options);
    result.xxh3 = core::hex_text(checksum.value());
    return result;
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("the name of a mesh file");
}

}  // namespace sdm

#include <sdm/io.h>

#include "io/read/file_bytes.h"
#include "io/read/read_polygons.h"

namespace sdm {

Mesh read_mesh(const std::filesystem::path& file) {
  return io::with_error_prefix(file.string(), [&] {
    Mesh mesh = io::to_mesh(io::read_polygons(io::read_bytes(file).view(), file));
    validate(mesh);
    return mesh;
  });
}

}  // namespace sdm

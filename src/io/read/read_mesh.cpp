#include <sdm/io.h>

#include "io/read/file_bytes.h"
#include "io/read/read_polygons.h"

namespace sdm {

Mesh read_mesh(const std::filesystem::path& file) {
  return naming(file.string(), [&] {
    Mesh mesh = to_mesh(read_polygons(read_bytes(file).view(), file));
    validate(mesh);
    return mesh;
  });
}

}  // namespace sdm

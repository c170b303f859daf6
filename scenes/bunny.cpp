#include "scenes/bunny.h"

#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <string>

namespace sdm::scenes {

Mesh read_bunny(const std::filesystem::path& file) {
  constexpr const char* kDefault = "/usr/share/glmark2/models/bunny.obj";
  if (file.empty() && !std::filesystem::exists(kDefault))
    throw Error(std::string("there is no mesh at ") + kDefault +
                "; install Debian's glmark2-data, or give another mesh file");
  return read_mesh(file.empty() ? kDefault : file);
}

}  // namespace sdm::scenes

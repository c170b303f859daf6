#include "io/mesh/formats.h"
#include "io/mesh/gltf/gltf_scene.h"

namespace sdm::io {

PolygonMesh read_gltf(std::string_view bytes, const std::filesystem::path& file, bool attributes) {
  try {
    const GltfDocument document(bytes, file.parent_path());
    return read_gltf_scene(document, gltf_instances(document), {}, attributes);
  } catch (const nlohmann::json::exception& fault) {
    throw_gltf_fault(fault);
  }
}

}  // namespace sdm::io

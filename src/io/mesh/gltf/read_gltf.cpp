#include "io/mesh/formats.h"
#include "io/mesh/gltf/gltf_materials.h"
#include "io/mesh/gltf/gltf_scene.h"

namespace sdm::io {

PolygonMesh read_gltf(std::string_view bytes, const std::filesystem::path& file, bool attributes) {
  try {
    const GltfDocument document(bytes, file.parent_path());
    PolygonMesh mesh = read_gltf_scene(document, gltf_instances(document), {}, attributes);
    if (attributes) read_gltf_materials(document, file.parent_path(), mesh.surfaces, mesh.notes);
    return mesh;
  } catch (const nlohmann::json::exception& fault) {
    throw_gltf_fault(fault);
  }
}

}  // namespace sdm::io

// The meshes of the nodes of a scene, and their copies.
#pragma once

#include <optional>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/gltf_nodes.h"

namespace sdm::io {

/// The mesh of a node, and its transform, which does not apply if the mesh has a skin.
struct GltfInstance {
  std::size_t node, mesh;
  GltfTransform to_scene;
  std::optional<std::size_t> skin{};
  GltfTransform to_node{};  ///< of a copy of the mesh; `to_scene` includes it
};

/// Returns all meshes of the default scene, in depth-first order of the nodes; those of a node with
/// EXT_mesh_gpu_instancing as often as it says. Their memory is charged to the document. Throws sdm::Error
/// for a node with both instances and a skin, which glTF does not define.
[[nodiscard]] std::vector<GltfInstance> gltf_instances(const GltfDocument& document);

}  // namespace sdm::io

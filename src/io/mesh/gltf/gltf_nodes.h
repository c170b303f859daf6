// The trees of nodes of a glTF file.
#pragma once

#include <functional>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/gltf_transform.h"

namespace sdm::io {

/// Returns the root nodes of the default scene; without one, of the first scene; without any scene, all nodes
/// without a parent.
[[nodiscard]] std::vector<std::size_t> gltf_scene_roots(const GltfDocument& document);
/// Returns all nodes without a parent.
[[nodiscard]] std::vector<std::size_t> gltf_roots(const GltfDocument& document);

/// Visits the nodes below and including `roots`, depth first, with their transforms to the scene. Throws
/// sdm::Error for a node with two parents, which could form a cycle or a tree of exponential size; glTF
/// forbids it.
void visit_gltf_nodes(const GltfDocument& document, const std::vector<std::size_t>& roots,
                      const std::function<void(std::size_t node, const GltfTransform& to_scene)>& visit);

}  // namespace sdm::io

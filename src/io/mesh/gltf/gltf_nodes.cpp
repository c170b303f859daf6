#include "io/mesh/gltf/gltf_nodes.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <utility>

namespace sdm::io {

using nlohmann::json;

std::vector<std::size_t> gltf_roots(const GltfDocument& document) {
  const json& nodes = list_of(document.root(), "nodes");
  std::vector<bool> is_child(nodes.size(), false);
  for (const json& node : nodes)
    for (const std::size_t child : whole_numbers(node, "children"))
      if (child < is_child.size()) is_child[child] = true;
  std::vector<std::size_t> result;
  for (std::size_t n = 0; n < is_child.size(); ++n)
    if (!is_child[n]) result.push_back(n);
  return result;
}

std::vector<std::size_t> gltf_scene_roots(const GltfDocument& document) {
  const json& root = document.root();
  if (list_of(root, "scenes").empty()) return gltf_roots(document);
  return whole_numbers(document.item("scenes", whole_number(root, "scene", 0)), "nodes");
}

void visit_gltf_nodes(const GltfDocument& document, const std::vector<std::size_t>& roots,
                      const std::function<void(std::size_t, const GltfTransform&)>& visit) {
  std::vector<std::pair<std::size_t, GltfTransform>> stack;
  const auto push = [&](const std::vector<std::size_t>& nodes, const GltfTransform& to_scene) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) stack.emplace_back(*node, to_scene);
  };
  std::vector<bool> met(list_of(document.root(), "nodes").size(), false);
  push(roots, {});
  while (!stack.empty()) {
    const auto [index, to_parent] = stack.back();
    stack.pop_back();
    const json& node = document.item("nodes", index);
    if (met[index]) throw Error(fmt::format("node {} has two parents, which glTF forbids", index));
    met[index] = true;
    const GltfTransform to_scene = to_parent * gltf_node_transform(node);
    visit(index, to_scene);
    push(whole_numbers(node, "children"), to_scene);
  }
}

}  // namespace sdm::io

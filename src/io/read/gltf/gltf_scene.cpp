#include "io/read/gltf/gltf_scene.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <utility>

namespace sdm::io {
namespace {

using nlohmann::json;

// From translation, rotation and scale, or a matrix in column-major order.
GltfTransform node_transform(const json& node) {
  GltfTransform t;
  if (node.contains("matrix")) {
    const auto m = node["matrix"].get<std::array<double, 16>>();
    for (std::size_t c = 0; c < 3; ++c) t.linear[c] = {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
    t.offset = {m[12], m[13], m[14]};
    return t;
  }
  const auto [x, y, z, w] = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
  const auto scale = node.value("scale", Vec3{1, 1, 1});
  t.linear = {{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
               {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
               {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
  for (int c = 0; c < 3; ++c) t.linear[c] = scale[c] * t.linear[c];
  t.offset = node.value("translation", Vec3{});
  return t;
}

// The root nodes of the default scene; without one, of the first scene; without any scene, all nodes without
// a parent.
std::vector<std::size_t> roots(const GltfDocument& document) {
  const json& root = document.root();
  if (root.contains("scenes") && !root["scenes"].empty())
    return whole_numbers(document.item("scenes", whole_number(root, "scene", 0)), "nodes");
  const json nodes = root.value("nodes", json::array());
  std::vector<bool> is_child(nodes.size(), false);
  for (const json& node : nodes)
    for (const std::size_t child : whole_numbers(node, "children"))
      if (child < is_child.size()) is_child[child] = true;
  std::vector<std::size_t> result;
  for (std::size_t n = 0; n < is_child.size(); ++n)
    if (!is_child[n]) result.push_back(n);
  return result;
}

}  // namespace

// A node with two parents could form a cycle, or a tree of exponential size; glTF forbids it.
std::vector<GltfInstance> gltf_instances(const GltfDocument& document) {
  std::vector<GltfInstance> result;
  std::vector<std::pair<std::size_t, GltfTransform>> stack;
  const auto push = [&](const std::vector<std::size_t>& nodes, const GltfTransform& to_scene) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) stack.emplace_back(*node, to_scene);
  };
  std::vector<bool> met(document.root().value("nodes", json::array()).size(), false);
  push(roots(document), {});
  while (!stack.empty()) {
    const auto [index, to_parent] = stack.back();
    stack.pop_back();
    const json& node = document.item("nodes", index);
    if (met[index]) throw Error(fmt::format("node {} has two parents, which glTF forbids", index));
    met[index] = true;
    const GltfTransform to_scene = to_parent * node_transform(node);
    if (node.contains("mesh")) result.push_back({index, whole_number(node, "mesh"), to_scene});
    push(whole_numbers(node, "children"), to_scene);
  }
  return result;
}

bool has_triangles(const json& primitive) {
  const std::size_t mode = gltf_mode(primitive);
  return mode >= kTriangles && mode <= kFan && primitive.at("attributes").contains("POSITION");
}

std::size_t gltf_mode(const json& primitive) {
  return whole_number(primitive, "mode", kTriangles);
}

}  // namespace sdm::io

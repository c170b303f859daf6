#include "io/mesh/gltf/gltf_nodes.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace sdm::io {

GltfTransform gltf_transform(const Vec3& translation, const std::array<double, 4>& rotation,
                             const Vec3& scale) {
  const auto [x, y, z, w] = rotation;
  const double squared_length = x * x + y * y + z * z + w * w;
  if (squared_length == 0) throw Error("a rotation is a quaternion of length 0");
  // 2 for unit quaternions; those stored as integers, or in single precision, have another length.
  const double s = 2 / squared_length;
  GltfTransform t;
  t.linear = {{{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
               {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
               {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)}}};
  for (std::size_t c = 0; c < 3; ++c) t.linear[c] = scale[c] * t.linear[c];
  t.offset = translation;
  return t;
}

GltfTransform gltf_matrix_transform(const std::array<double, 16>& m) {
  constexpr double kAffine = 1e-5;
  if (std::abs(m[3]) > kAffine || std::abs(m[7]) > kAffine || std::abs(m[11]) > kAffine ||
      std::abs(m[15] - 1) > kAffine)
    throw Error("a matrix is not affine: its last row is not 0 0 0 1");
  GltfTransform t;
  for (std::size_t c = 0; c < 3; ++c) t.linear[c] = {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
  t.offset = {m[12], m[13], m[14]};
  return t;
}

GltfTransform gltf_node_transform(const nlohmann::json& node) {
  if (node.contains("matrix")) return gltf_matrix_transform(node["matrix"].get<std::array<double, 16>>());
  return gltf_transform(Vec3{node.value("translation", std::array<double, 3>{})},
                        node.value("rotation", std::array<double, 4>{0, 0, 0, 1}),
                        Vec3{node.value("scale", std::array<double, 3>{1, 1, 1})});
}

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

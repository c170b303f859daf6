#include "io/mesh/gltf/gltf_skin.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <string>

#include "io/mesh/gltf/gltf_nodes.h"

namespace sdm::io {
namespace {

using nlohmann::json;

constexpr std::size_t kJointsPerSet = 4;

GltfRows influence_rows(const GltfDocument& document, const json& attributes, const std::string& name,
                        std::size_t vertices) {
  if (!attributes.contains(name)) throw Error(fmt::format("a mesh with a skin has no attribute {}", name));
  const GltfRows rows(document, whole_number(attributes, name.c_str()));
  if (rows.columns() != kJointsPerSet) throw Error(fmt::format("the attribute {} is not of type VEC4", name));
  if (rows.rows() != vertices)
    throw Error(fmt::format("the attribute {} and the mesh differ in their number of vertices", name));
  return rows;
}

// sum + s · t
GltfTransform plus_scaled(const GltfTransform& sum, double s, const GltfTransform& t) {
  return {{sum.linear[0] + s * t.linear[0], sum.linear[1] + s * t.linear[1], sum.linear[2] + s * t.linear[2]},
          sum.offset + s * t.offset};
}

}  // namespace

GltfPlacement::GltfPlacement(const GltfTransform& to_scene)
    : to_scene_(to_scene), mirrors_(to_scene.determinant() < 0) {}

GltfPlacement::GltfPlacement(const GltfDocument& document, const std::vector<GltfTransform>& joints,
                             const json& attributes)
    : joints_(&joints),
      mirrors_(std::ranges::all_of(joints, [](const GltfTransform& t) { return t.determinant() < 0; })) {
  const std::size_t vertices = document.count(whole_number(attributes, "POSITION"));
  for (std::size_t set = 0;; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set),
                      weights_name = fmt::format("WEIGHTS_{}", set);
    if (set > 0 && !attributes.contains(joints_name) && !attributes.contains(weights_name)) return;
    influences_.push_back({influence_rows(document, attributes, joints_name, vertices),
                           influence_rows(document, attributes, weights_name, vertices)});
  }
}

// Dividing by the sum of the weights is what the division by the last coordinate does.
GltfTransform GltfPlacement::blend(std::size_t vertex) const {
  const GltfTransform zero{{}, {}};
  GltfTransform sum = zero;
  double weights = 0;
  for (const Influences& set : influences_)
    for (std::size_t k = 0; k < kJointsPerSet; ++k) {
      const double weight = set.weights.number(vertex, k), joint = set.joints.number(vertex, k);
      if (weight == 0) continue;
      if (!(weight > 0)) throw Error(fmt::format("vertex {} of a skin has the weight {}", vertex, weight));
      if (!(joint >= 0 && joint < static_cast<double>(joints_->size())))
        throw Error(
            fmt::format("vertex {} of a skin follows joint {} of {}", vertex, joint, joints_->size()));
      sum = plus_scaled(sum, weight, (*joints_)[static_cast<std::size_t>(joint)]);
      weights += weight;
    }
  if (weights == 0)
    throw Error(fmt::format("vertex {} of a skin follows no joint: its weights are 0", vertex));
  return weights == 1 ? sum : plus_scaled(zero, 1 / weights, sum);
}

GltfPlacement GltfSkins::placement(const GltfInstance& instance, const json& primitive) {
  if (!instance.skin) return GltfPlacement(instance.to_scene);
  return GltfPlacement(document_, joints(*instance.skin), primitive.at("attributes"));
}

const std::vector<GltfTransform>& GltfSkins::joints(std::size_t skin_index) {
  const auto [entry, is_new] = joints_.try_emplace(skin_index);
  std::vector<GltfTransform>& transforms = entry->second;
  if (!is_new) return transforms;
  const json& skin = document_.item("skins", skin_index);
  const json& nodes = list_of(skin, "joints");
  if (nodes.empty()) throw Error(fmt::format("skin {} has no joints", skin_index));
  std::optional<GltfRows>
      to_joint;  // the inverse bind matrices; without them, joints are where they were bound
  if (skin.contains("inverseBindMatrices")) {
    to_joint.emplace(document_, whole_number(skin, "inverseBindMatrices"));
    constexpr std::size_t kMatrix = 16;
    if (to_joint->columns() != kMatrix || to_joint->rows() < nodes.size())
      throw Error(
          fmt::format("the inverse bind matrices of skin {} are not one MAT4 for each of its {} joints",
                      skin_index, nodes.size()));
  }
  document_.charge(nodes.size() * sizeof(GltfTransform), "a skin");
  const std::vector<std::size_t> joint_nodes = whole_numbers(skin, "joints");
  transforms.reserve(joint_nodes.size());
  for (std::size_t j = 0; j < joint_nodes.size(); ++j) {
    GltfTransform bind;
    if (to_joint) {
      std::array<double, 16> matrix;
      for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] = to_joint->number(j, i);
      bind = gltf_matrix_transform(matrix);
    }
    transforms.push_back(node_to_scene(joint_nodes[j]) * bind);
  }
  return transforms;
}

const GltfTransform& GltfSkins::node_to_scene(std::size_t node) {
  if (nodes_.empty()) {
    nodes_.resize(list_of(document_.root(), "nodes").size());
    visit_gltf_nodes(document_, gltf_roots(document_),
                     [&](std::size_t n, const GltfTransform& to_scene) { nodes_[n] = to_scene; });
  }
  if (node >= nodes_.size() || !nodes_[node])
    throw Error(fmt::format("a skin refers to the joint at node {}, which does not exist in any tree", node));
  return *nodes_[node];
}

}  // namespace sdm::io

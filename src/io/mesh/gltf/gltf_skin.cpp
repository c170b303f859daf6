#include "io/mesh/gltf/gltf_skin.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <string>

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

std::vector<GltfTransform> GltfJoints::to_scene(const GltfPose& pose) const {
  std::vector<GltfTransform> transforms;
  transforms.reserve(nodes.size());
  for (std::size_t j = 0; j < nodes.size(); ++j) transforms.push_back(pose.to_scene(nodes[j]) * from_rest[j]);
  return transforms;
}

GltfJoints gltf_joints(const GltfDocument& document, const GltfPose& pose, std::size_t skin_index) {
  const json& skin = document.item("skins", skin_index);
  GltfJoints joints;
  joints.nodes = whole_numbers(skin, "joints");
  const std::size_t count = joints.nodes.size();
  if (count == 0) throw Error(fmt::format("skin {} has no joints", skin_index));
  for (const std::size_t node : joints.nodes)
    if (!pose.has(node))
      throw Error(
          fmt::format("a skin refers to the joint at node {}, which does not exist in any tree", node));
  document.charge(2 * count * sizeof(GltfTransform), "a skin");
  joints.from_rest.resize(count);  // joints are where they were bound, unless there are matrices
  if (!skin.contains("inverseBindMatrices")) return joints;
  const GltfRows matrices(document, whole_number(skin, "inverseBindMatrices"));
  std::array<double, 16> matrix;
  if (matrices.columns() != matrix.size() || matrices.rows() < count)
    throw Error(fmt::format("the inverse bind matrices of skin {} are not one MAT4 for each of its {} joints",
                            skin_index, count));
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] = matrices.number(j, i);
    joints.from_rest[j] = gltf_matrix_transform(matrix);
  }
  return joints;
}

GltfInfluences::GltfInfluences(const GltfDocument& document, const json& attributes, std::size_t joints)
    : joints_(joints) {
  const std::size_t vertices = document.count(whole_number(attributes, "POSITION"));
  for (std::size_t set = 0;; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set),
                      weights_name = fmt::format("WEIGHTS_{}", set);
    if (set > 0 && !attributes.contains(joints_name) && !attributes.contains(weights_name)) return;
    sets_.push_back({influence_rows(document, attributes, joints_name, vertices),
                     influence_rows(document, attributes, weights_name, vertices)});
  }
}

std::size_t GltfInfluences::most() const {
  return kJointsPerSet * sets_.size();
}

// Dividing by the sum of the weights is what the division by the last coordinate does.
void GltfInfluences::append(std::size_t vertex, std::vector<Influence>& influences) const {
  const std::size_t first = influences.size();
  double sum = 0;
  for (const Set& set : sets_)
    for (std::size_t k = 0; k < kJointsPerSet; ++k) {
      const double weight = set.weights.number(vertex, k), joint = set.joints.number(vertex, k);
      if (weight == 0) continue;
      if (!(weight > 0)) throw Error(fmt::format("vertex {} of a skin has the weight {}", vertex, weight));
      if (!(joint >= 0 && joint < static_cast<double>(joints_)))
        throw Error(fmt::format("vertex {} of a skin follows joint {} of {}", vertex, joint, joints_));
      influences.push_back({static_cast<std::uint32_t>(joint), weight});
      sum += weight;
    }
  if (sum == 0) throw Error(fmt::format("vertex {} of a skin follows no joint: its weights are 0", vertex));
  for (std::size_t i = first; i < influences.size(); ++i) influences[i].weight /= sum;
}

GltfTransform blend(const std::vector<GltfTransform>& joints,
                    std::span<const GltfInfluences::Influence> influences) {
  GltfTransform sum{{}, {}};
  for (const auto& [joint, weight] : influences) sum = plus_scaled(sum, weight, joints[joint]);
  return sum;
}

GltfPlacement::GltfPlacement(const GltfTransform& to_scene)
    : to_scene_(to_scene), mirrors_(to_scene.determinant() < 0) {}

GltfPlacement::GltfPlacement(const GltfDocument& document, const std::vector<GltfTransform>& joints,
                             const json& attributes)
    : joints_(&joints),
      influences_(GltfInfluences(document, attributes, joints.size())),
      mirrors_(std::ranges::all_of(joints, [](const GltfTransform& t) { return t.determinant() < 0; })) {}

GltfTransform GltfPlacement::operator[](std::size_t vertex) const {
  if (joints_ == nullptr) return to_scene_;
  thread_local std::vector<GltfInfluences::Influence> influences;
  influences.clear();
  influences_->append(vertex, influences);
  return blend(*joints_, influences);
}

GltfPlacement GltfSkins::placement(const GltfInstance& instance, const json& primitive) {
  if (!instance.skin) return GltfPlacement(instance.to_scene);
  return GltfPlacement(document_, joints(*instance.skin), primitive.at("attributes"));
}

const std::vector<GltfTransform>& GltfSkins::joints(std::size_t skin) {
  if (const auto known = joints_.find(skin); known != joints_.end()) return known->second;
  if (pose_ == nullptr) pose_ = &of_file_.emplace(document_);
  return joints_.emplace(skin, gltf_joints(document_, *pose_, skin).to_scene(*pose_)).first->second;
}

}  // namespace sdm::io

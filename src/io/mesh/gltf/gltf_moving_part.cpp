#include "io/mesh/gltf/gltf_moving_part.h"

#include <algorithm>

#include "io/mesh/gltf/gltf_morph.h"

namespace sdm::io {

using nlohmann::json;

GltfMovingPart::GltfMovingPart(const GltfDocument& document, const GltfInstance& instance,
                               const json& primitive, const std::optional<std::vector<double>>& weights,
                               std::size_t joints)
    : node_(instance.node), to_node_(instance.to_node), skin_(instance.skin) {
  const GltfPositions positions(document, primitive, weights.value_or(std::vector<double>()));
  document.charge(positions.size() * sizeof(Vec3), "the animation");
  rest_.reserve(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) rest_.push_back(positions[v]);
  if (!weights) add_targets(document, primitive);
  if (skin_) add_influences(document, primitive.at("attributes"), joints);
}

void GltfMovingPart::add_targets(const GltfDocument& document, const json& primitive) {
  for (const std::optional<GltfRows>& rows : gltf_displacements(document, primitive)) {
    std::vector<Displaced>& displaced = targets_.emplace_back();
    if (!rows) continue;
    document.charge(rows->stored_rows() * sizeof(Displaced), "the morph targets");
    displaced.reserve(rows->stored_rows());
    for (std::size_t i = 0; i < rows->stored_rows(); ++i) {
      const std::size_t v = rows->stored_row(i);
      displaced.push_back({static_cast<std::uint32_t>(v), rows->vec3(v)});
    }
  }
}

void GltfMovingPart::add_influences(const GltfDocument& document, const json& attributes,
                                    std::size_t joints) {
  const GltfInfluences influences(document, attributes, joints);
  document.charge(rest_.size() * (sizeof(std::size_t) + influences.most() * sizeof(influences_[0])),
                  "the skins");
  ends_.reserve(rest_.size());
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    influences.append(v, influences_);
    ends_.push_back(influences_.size());
  }
}

void GltfMovingPart::place(const GltfMoment& moment, std::span<Vec3> positions) const {
  std::ranges::copy(rest_, positions.begin());
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    const double weight = moment.weights.at(node_)[t];
    for (const auto& [v, displacement] : targets_[t]) positions[v] += weight * displacement;
  }
  if (!skin_) {
    const GltfTransform to_scene = moment.pose.to_scene(node_) * to_node_;
    for (Vec3& p : positions) p = to_scene(p);
    return;
  }
  const std::vector<GltfTransform>& joints = moment.joints.at(*skin_);
  const std::span<const GltfInfluences::Influence> all = influences_;
  for (std::size_t v = 0, begin = 0; v < positions.size(); begin = ends_[v++])
    positions[v] = blend(joints, all.subspan(begin, ends_[v] - begin))(positions[v]);
}

}  // namespace sdm::io

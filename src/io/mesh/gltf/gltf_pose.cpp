#include "io/mesh/gltf/gltf_pose.h"

#include <utility>

#include "io/mesh/gltf/gltf_nodes.h"

namespace sdm::io {

GltfPose::GltfPose(const GltfDocument& document, std::map<std::size_t, GltfMotion> motions)
    : motions_(std::move(motions)) {
  const std::size_t nodes = list_of(document.root(), "nodes").size();
  document.charge(nodes * sizeof(to_scene_[0]), "the nodes");
  to_scene_.resize(nodes);
  std::vector<std::optional<std::size_t>> parents;
  if (!motions_.empty()) {
    document.charge(nodes * (sizeof(Mover) + 2 * sizeof(parents[0])), "the nodes");
    parents.resize(nodes);
    carriers_.resize(nodes);
  }
  visit_gltf_nodes(document, gltf_roots(document), [&](std::size_t index, const GltfTransform& to_scene) {
    to_scene_[index] = to_scene;
    if (motions_.empty()) return;
    const nlohmann::json& node = document.item("nodes", index);
    for (const std::size_t child : whole_numbers(node, "children"))
      if (child < nodes) parents[child] = index;
    const auto motion = motions_.find(index);
    const bool moves = motion != motions_.end();
    if (moves)
      carriers_[index] = index;
    else if (parents[index])
      carriers_[index] = carriers_[*parents[index]];
    if (carriers_[index])
      movers_.push_back({index, parents[index], moves ? &motion->second : nullptr,
                         moves ? GltfTransform{} : gltf_node_transform(node)});
  });
}

void GltfPose::move_to(double time) {
  for (const Mover& mover : movers_) {
    const GltfTransform local = mover.motion ? mover.motion->at(time) : mover.local;
    to_scene_[mover.node] = mover.parent ? to_scene(*mover.parent) * local : local;
  }
}

std::optional<std::size_t> GltfPose::carrier(std::size_t node) const {
  return node < carriers_.size() ? carriers_[node] : std::nullopt;
}

}  // namespace sdm::io

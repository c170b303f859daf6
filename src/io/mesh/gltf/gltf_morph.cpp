#include "io/mesh/gltf/gltf_morph.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <utility>

namespace sdm::io {

using nlohmann::json;

std::size_t gltf_target_count(const GltfDocument& document, std::size_t mesh) {
  std::size_t count = 0;
  for (const json& primitive : list_of(document.item("meshes", mesh), "primitives"))
    count = std::max(count, list_of(primitive, "targets").size());
  return count;
}

std::vector<double> gltf_weights(const GltfDocument& document, const GltfInstance& instance) {
  const std::size_t targets = gltf_target_count(document, instance.mesh);
  if (targets == 0) return {};  // weights without targets change nothing
  for (const json* owner :
       {&document.item("nodes", instance.node), &document.item("meshes", instance.mesh)}) {
    if (!owner->contains("weights")) continue;
    auto weights = owner->at("weights").get<std::vector<double>>();
    if (weights.size() != targets)
      throw Error(
          fmt::format("mesh {} has {} weights for {} morph targets", instance.mesh, weights.size(), targets));
    return weights;
  }
  return std::vector<double>(targets, 0.0);
}

std::vector<std::optional<GltfRows>> gltf_displacements(const GltfDocument& document, const json& primitive) {
  const std::size_t vertices = document.count(whole_number(primitive.at("attributes"), "POSITION"));
  std::vector<std::optional<GltfRows>> result;
  for (const json& target : list_of(primitive, "targets")) {
    auto& displacements = result.emplace_back();
    if (!target.contains("POSITION")) continue;
    displacements.emplace(document, whole_number(target, "POSITION"));
    if (displacements->rows() != vertices)
      throw Error("a morph target and its mesh differ in their number of vertices");
    if (displacements->columns() != 3) throw Error("the positions of a morph target are not of type VEC3");
  }
  return result;
}

GltfPositions::GltfPositions(const GltfDocument& document, const json& primitive, std::vector<double> weights)
    : rest_(document, whole_number(primitive.at("attributes"), "POSITION")),
      displacements_(gltf_displacements(document, primitive)),
      weights_(std::move(weights)) {
  if (rest_.columns() != 3) throw Error("the positions of a mesh are not of type VEC3");
  weights_.resize(std::min(weights_.size(), displacements_.size()));
}

Vec3 GltfPositions::operator[](std::size_t vertex) const {
  Vec3 position = rest_.vec3(vertex);
  for (std::size_t t = 0; t < weights_.size(); ++t)
    if (weights_[t] != 0 && displacements_[t]) position += weights_[t] * displacements_[t]->vec3(vertex);
  return position;
}

}  // namespace sdm::io

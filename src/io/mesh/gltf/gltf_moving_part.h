// Primitives whose vertices an animation moves.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "io/mesh/gltf/gltf_instances.h"
#include "io/mesh/gltf/gltf_pose.h"
#include "io/mesh/gltf/gltf_skin.h"

namespace sdm::io {

/// What an animation makes of a document at one moment.
struct GltfMoment {
  GltfPose pose;
  std::map<std::size_t, std::vector<double>> weights{};        ///< of morph targets, by node
  std::map<std::size_t, std::vector<GltfTransform>> joints{};  ///< from rest to the scene, by skin
};

/// The vertices of a primitive of an instance, without the document.
class GltfMovingPart {
 public:
  /// `weights` of the file's morph targets; nothing if they are animated. `joints`: of the instance's skin,
  /// if it has one. Memory is charged to the document. Throws sdm::Error for faults.
  GltfMovingPart(const GltfDocument& document, const GltfInstance& instance, const nlohmann::json& primitive,
                 const std::optional<std::vector<double>>& weights, std::size_t joints);

  [[nodiscard]] std::size_t size() const { return rest_.size(); }
  /// Computes all positions in the scene. Cost: linear in the vertices, their displacements and joints.
  void place(const GltfMoment& moment, std::span<Vec3> positions) const;

 private:
  /// A vertex that a morph target displaces.
  struct Displaced {
    std::uint32_t vertex;
    Vec3 displacement;
  };
  void add_targets(const GltfDocument& document, const nlohmann::json& primitive);
  void add_influences(const GltfDocument& document, const nlohmann::json& attributes, std::size_t joints);

  std::size_t node_;
  GltfTransform to_node_;
  std::optional<std::size_t> skin_;
  std::vector<Vec3> rest_;                       // in the coordinates of the mesh
  std::vector<std::vector<Displaced>> targets_;  // whose weights are animated
  std::vector<GltfInfluences::Influence> influences_;
  std::vector<std::size_t> ends_;  // of the influences of each vertex; empty without a skin
};

}  // namespace sdm::io

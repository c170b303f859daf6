// Where the nodes of a glTF file are.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "io/mesh/gltf/gltf_animation.h"
#include "io/mesh/gltf/gltf_instances.h"
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

/// The transforms of all nodes to the scene: those of the file, or of a moment of an animation.
class GltfPose {
 public:
  /// As they are in the file. Throws sdm::Error as visit_gltf_nodes().
  explicit GltfPose(const GltfDocument& document) : GltfPose(document, {}) {}
  /// Moved by `motions`, by node; at first as in the file.
  GltfPose(const GltfDocument& document, std::map<std::size_t, GltfMotion> motions);
  GltfPose(const GltfPose&) = delete;
  GltfPose& operator=(const GltfPose&) = delete;

  /// Moves the nodes to their places at a time. Cost: linear in the nodes that move.
  void move_to(double time);

  /// Whether there is such a node, in a tree.
  [[nodiscard]] bool has(std::size_t node) const { return node < to_scene_.size() && to_scene_[node]; }
  /// Only of a node that there is.
  [[nodiscard]] const GltfTransform& to_scene(std::size_t node) const { return *to_scene_[node]; }
  /// Returns the node that carries this one: itself, if it moves, otherwise the next one above it that moves;
  /// nothing if the node is at rest.
  [[nodiscard]] std::optional<std::size_t> carrier(std::size_t node) const;

 private:
  /// A node that moves, itself or with one above it.
  struct Mover {
    std::size_t node;
    std::optional<std::size_t> parent;
    const GltfMotion* motion;  ///< null: its local transform stays
    GltfTransform local{};
  };

  std::map<std::size_t, GltfMotion> motions_;
  std::vector<std::optional<GltfTransform>> to_scene_;  // by node; nothing for those in no tree
  std::vector<std::optional<std::size_t>> carriers_;    // by node; empty if none moves
  std::vector<Mover> movers_;                           // parents first
};

}  // namespace sdm::io

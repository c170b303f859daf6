// Where the nodes of a glTF file are.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "io/mesh/gltf/gltf_animation.h"

namespace sdm::io {

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

// Skins: vertices that follow the joints of a skeleton.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "io/mesh/gltf/document/gltf_rows.h"
#include "io/mesh/gltf/gltf_instances.h"
#include "io/mesh/gltf/gltf_pose.h"

namespace sdm::io {

/// The joints of a skin.
struct GltfJoints {
  std::vector<std::size_t> nodes;
  std::vector<GltfTransform> from_rest;  ///< to each joint: the inverse bind matrices

  /// Returns the transforms from positions at rest to the scene.
  [[nodiscard]] std::vector<GltfTransform> to_scene(const GltfPose& pose) const;
};

/// Reads the joints of a skin, all of which have a place in the pose. Throws sdm::Error for faults.
[[nodiscard]] GltfJoints gltf_joints(const GltfDocument& document, const GltfPose& pose, std::size_t skin);

/// The joints that the vertices of a primitive follow. The document must outlive the object.
class GltfInfluences {
 public:
  struct Influence {
    std::uint32_t joint;
    double weight;
  };

  /// Throws sdm::Error if the attributes of the primitive do not give joints and weights to its vertices.
  GltfInfluences(const GltfDocument& document, const nlohmann::json& attributes, std::size_t joints);

  /// Returns the most that a vertex has.
  [[nodiscard]] std::size_t most() const;
  /// Adds those of a vertex; their weights sum to 1. Throws sdm::Error if a joint does not exist, or no
  /// weight is greater than 0.
  void append(std::size_t vertex, std::vector<Influence>& influences) const;

 private:
  struct Set {
    GltfRows joints, weights;  ///< four of each vertex
  };
  std::size_t joints_;
  std::vector<Set> sets_;
};

/// The average of transforms of joints, by weights.
[[nodiscard]] GltfTransform blend(const std::vector<GltfTransform>& joints,
                                  std::span<const GltfInfluences::Influence> influences);

/// Where the vertices of a primitive are in the scene: moved by the transform of its node, or by the joints
/// of a skin, which replace that (glTF 2.0, 3.7.3).
class GltfPlacement {
 public:
  /// Places what belongs to a node without a skin.
  explicit GltfPlacement(const GltfTransform& to_scene);
  /// `joints` move positions at rest to the scene, and must outlive the object. Throws sdm::Error if the
  /// attributes of the primitive do not give a joint and a weight to each of its vertices.
  GltfPlacement(const GltfDocument& document, const std::vector<GltfTransform>& joints,
                const nlohmann::json& attributes);

  /// The transform of a vertex: the average of those of its joints, by its weights.
  [[nodiscard]] GltfTransform operator[](std::size_t vertex) const;
  /// Whether triangles change their orientation. Those of a skin only if all joints mirror.
  [[nodiscard]] bool mirrors() const { return mirrors_; }

 private:
  GltfTransform to_scene_;
  const std::vector<GltfTransform>* joints_ = nullptr;  // null: no skin
  std::optional<GltfInfluences> influences_;
  bool mirrors_ = false;
};

/// The skins of a document.
class GltfSkins {
 public:
  /// `pose`: of the nodes of joints; null: that of the file. Both must outlive the object.
  explicit GltfSkins(const GltfDocument& document, const GltfPose* pose = nullptr)
      : document_(document), pose_(pose) {}

  /// Returns the placement of a primitive of an instance, valid as long as the skins.
  [[nodiscard]] GltfPlacement placement(const GltfInstance& instance, const nlohmann::json& primitive);

 private:
  /// The transforms of the joints of a skin, from positions at rest to the scene.
  [[nodiscard]] const std::vector<GltfTransform>& joints(std::size_t skin);

  const GltfDocument& document_;
  const GltfPose* pose_;
  std::optional<GltfPose> of_file_;                           // once a skin is used
  std::map<std::size_t, std::vector<GltfTransform>> joints_;  // of each skin that is used
};

}  // namespace sdm::io

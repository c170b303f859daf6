// Skins: vertices that follow the joints of a skeleton.
#pragma once

#include <map>
#include <vector>

#include "io/mesh/gltf/document/gltf_rows.h"
#include "io/mesh/gltf/gltf_instances.h"

namespace sdm::io {

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
  [[nodiscard]] GltfTransform operator[](std::size_t vertex) const {
    return joints_ == nullptr ? to_scene_ : blend(vertex);
  }
  /// Whether triangles change their orientation. Those of a skin only if all joints mirror.
  [[nodiscard]] bool mirrors() const { return mirrors_; }

 private:
  struct Influences {
    GltfRows joints, weights;  ///< four of each vertex
  };
  [[nodiscard]] GltfTransform blend(std::size_t vertex) const;

  GltfTransform to_scene_;
  const std::vector<GltfTransform>* joints_ = nullptr;  // null: no skin
  std::vector<Influences> influences_;
  bool mirrors_ = false;
};

/// The skins of a document, in the pose that the nodes of their joints have in the file.
class GltfSkins {
 public:
  explicit GltfSkins(const GltfDocument& document) : document_(document) {}

  /// Returns the placement of a primitive of an instance, valid as long as the skins.
  [[nodiscard]] GltfPlacement placement(const GltfInstance& instance, const nlohmann::json& primitive);

 private:
  /// The transforms of the joints of a skin, from positions at rest to the scene.
  [[nodiscard]] const std::vector<GltfTransform>& joints(std::size_t skin);
  [[nodiscard]] const GltfTransform& node_to_scene(std::size_t node);

  const GltfDocument& document_;
  std::map<std::size_t, std::vector<GltfTransform>> joints_;  // of each skin that is used
  std::vector<std::optional<GltfTransform>> nodes_;           // empty until a skin is used
};

}  // namespace sdm::io

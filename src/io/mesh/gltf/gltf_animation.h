// What an animation of a glTF file changes.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "io/mesh/gltf/gltf_track.h"
#include "io/mesh/gltf/gltf_transform.h"

namespace sdm::io {

/// The local transform of a node over time.
class GltfMotion {
 public:
  /// Starts as the transform of the node. Throws sdm::Error if that is a matrix, which glTF forbids for a
  /// node that moves.
  GltfMotion(const GltfDocument& document, std::size_t node);

  /// Adds a channel: `path` is "translation", "rotation" or "scale".
  void add(const GltfDocument& document, const std::string& path, const nlohmann::json& sampler);

  [[nodiscard]] GltfTransform at(double time) const;
  /// Adds the times of all keys.
  void add_times(std::vector<double>& times) const;

 private:
  Vec3 translation_, scale_;
  std::array<double, 4> rotation_;
  std::optional<GltfTrack> translations_, rotations_, scales_;
};

/// The transforms of nodes, and the weights of their morph targets, by node.
struct GltfAnimation {
  std::map<std::size_t, GltfMotion> motions{};
  std::map<std::size_t, GltfTrack> weights{};

  [[nodiscard]] bool empty() const { return motions.empty() && weights.empty(); }
  /// Returns the times of all keys, each once, increasing.
  [[nodiscard]] std::vector<double> times() const;
};

/// Reads the first animation of the file that changes nodes or weights; an empty one if there is none.
/// Channels of other things, such as those of extensions, are left out. Throws sdm::Error for faults.
[[nodiscard]] GltfAnimation gltf_animation(const GltfDocument& document);

}  // namespace sdm::io

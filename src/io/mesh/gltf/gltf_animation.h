// What an animation of a glTF file changes.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/gltf_nodes.h"

namespace sdm::io {

/// What one channel of an animation changes: a row of numbers over time.
class GltfTrack {
 public:
  /// The weights of a node with `targets` targets.
  [[nodiscard]] static GltfTrack weights(const GltfDocument& document, const nlohmann::json& sampler,
                                         std::size_t targets);
  /// Translations or scales, named by `path`.
  [[nodiscard]] static GltfTrack vectors(const GltfDocument& document, const nlohmann::json& sampler,
                                         std::string_view path);
  /// Quaternions (x, y, z, w), of any length, which LINEAR interpolates along the shorter arc.
  [[nodiscard]] static GltfTrack rotations(const GltfDocument& document, const nlohmann::json& sampler);

  /// Returns the times of the keys: at least one, finite, increasing.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// Returns the number of values at a time.
  [[nodiscard]] std::size_t columns() const { return columns_; }
  /// Computes the values. They are constant before the first key and after the last.
  void sample(double time, std::span<double> values) const;

 private:
  enum class Interpolation { step, linear, arc, cubic };

  /// Reads a sampler of an animation. Throws sdm::Error if times do not increase, or the number of values
  /// does not match them.
  GltfTrack(const GltfDocument& document, const nlohmann::json& sampler, std::size_t columns,
            std::string_view values, std::string_view row);

  /// Returns the in-tangents (-1), values (0) or out-tangents (1) of key k.
  [[nodiscard]] const double* key(std::size_t k, int part = 0) const;
  void make_unit_length();
  /// Between key k and the next one, at a fraction of the time between them.
  void interpolate(std::size_t k, double fraction, std::span<double> values) const;

  Interpolation interpolation_;
  std::size_t columns_;
  std::vector<double> times_, values_;
};

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

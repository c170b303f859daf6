// The values of a channel over time (glTF 2.0, Animations and appendix C, Interpolation).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"

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

}  // namespace sdm::io

// Weights of morph targets over time (glTF 2.0, Animations and appendix C, Interpolation).
#pragma once

#include <span>
#include <vector>

#include "io/mesh/gltf/document/gltf_document.h"

namespace sdm::io {

/// The weights of one node over time.
class WeightTrack {
 public:
  /// Reads the sampler of an animation, for a node with `targets` targets. Throws sdm::Error if times do not
  /// increase, or the number of values does not match them.
  WeightTrack(const GltfDocument& document, const nlohmann::json& sampler, std::size_t targets);

  /// Returns the times of the keys: at least one, finite, increasing.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] std::size_t targets() const { return targets_; }
  /// Computes the weights of all targets. They are constant before the first key and after the last.
  void sample(double time, std::span<double> weights) const;

 private:
  enum class Interpolation { step, linear, cubic };

  /// Returns the in-tangents (-1), values (0) or out-tangents (1) of key k.
  [[nodiscard]] const double* key(std::size_t k, int part = 0) const;

  Interpolation interpolation_;
  std::size_t targets_;
  std::vector<double> times_, values_;
};

}  // namespace sdm::io

// Weights of morph targets over time (glTF 2.0, Animations and appendix C, Interpolation).
#pragma once

#include <span>
#include <vector>

#include "io/read/gltf_document.h"

namespace sdm::io {

/// The sampler of an animation's channel, for a node with so many targets.
class WeightTrack {
 public:
  /// Throws sdm::Error where times do not increase, or values do not match them.
  WeightTrack(const GltfDocument& document, const nlohmann::json& sampler, std::size_t targets);

  /// When its keys are: at least one, finite, increasing.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] std::size_t targets() const { return targets_; }
  /// The weight of each target; before the first key and after the last one, that key's.
  void sample(double time, std::span<double> weights) const;

 private:
  enum class Interpolation { step, linear, cubic };

  /// Of key k: its in-tangents (-1), values (0) or out-tangents (1).
  [[nodiscard]] const double* key(std::size_t k, int part = 0) const;

  Interpolation interpolation_;
  std::size_t targets_;
  std::vector<double> times_, values_;
};

}  // namespace sdm::io

// Distances of a surface's samples to another body, where they matter.
#pragma once

#include <span>
#include <vector>

#include "query/body.h"

namespace sdm {

/// Samples come in runs of neighbours. Each run is probed at one of its samples, which bounds the distances
/// of the others, for these are 1-Lipschitz; then those runs are measured whose points can be within reach. A
/// distance to the inside of a solid is negative.
class LocalDistances {
 public:
  /// Consecutive samples.
  struct Run {
    std::size_t first = 0, end = 0;
    double distance = 0;  ///< of the sample that is probed
    double spread = 0;    ///< no sample of the run, and no point that one covers, is farther from that sample
    [[nodiscard]] std::size_t probe() const { return first + (end - first) / 2; }
    /// No sample of the run, and no point that it covers, is nearer.
    [[nodiscard]] double least() const { return distance - spread; }
  };

  /// Probes the runs of a body's samples, on all cores. The bodies must stay until these are measured.
  void probe(const Body& on, const Body& to);
  /// The least of the |distances| probed.
  [[nodiscard]] double least_probed() const;
  /// Measures the runs that can be nearer than `reach`, or are inside, on all cores.
  void measure(double reach);

  /// Those that have been measured, in increasing order.
  [[nodiscard]] std::span<const Run> measured() const { return measured_; }
  /// Of each sample of the runs measured.
  [[nodiscard]] std::span<const float> distances() const { return distances_; }

 private:
  const Body *on_ = nullptr, *to_ = nullptr;
  std::vector<Run> runs_, measured_;
  std::vector<Vec3> probes_;
  std::vector<float> distances_;
};

}  // namespace sdm

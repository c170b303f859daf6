// Distances of a surface's samples to another body, where they matter.
#pragma once

#include <span>
#include <vector>

#include "query/body.h"

namespace sdm {

/// Each run of samples is probed at one of them, which bounds the distances of the others, for these are
/// 1-Lipschitz; then those runs are measured whose points can be within reach. A distance to the inside of a
/// solid is negative. What is not measured costs next to nothing: its samples are not even placed.
class LocalDistances {
 public:
  /// Probes the runs of a body's samples, on all cores. The bodies must stay until these are measured.
  void probe(const Body& on, const Body& to);
  /// The least of the |distances| probed.
  [[nodiscard]] double least_probed() const;
  /// Measures the runs that can be nearer than `reach`, or are inside, on all cores.
  void measure(double reach);

  // The samples measured, run by run, in increasing order: their points, covering radii (see
  // Surface::sample_radii) and distances.
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }
  [[nodiscard]] std::span<const float> radii() const { return radii_; }
  [[nodiscard]] std::span<const float> distances() const { return distances_; }
  /// Which of the surface's samples the i-th one is.
  [[nodiscard]] std::size_t sample(std::size_t i) const;

 private:
  struct Probe {
    double distance = 0;
    double spread =
        0;  ///< no sample of the run, and no point that one covers, is farther from the one probed
    /// No sample of the run, and no point that it covers, is nearer.
    [[nodiscard]] double least() const { return distance - spread; }
  };
  void measure_runs(std::size_t begin, std::size_t end);

  const Body *on_ = nullptr, *to_ = nullptr;
  std::vector<Vec3> probe_points_;  ///< of all runs
  std::vector<Probe> probes_;
  std::vector<std::size_t> measured_;  ///< runs
  std::vector<Vec3> points_;
  std::vector<float> radii_, distances_;
};

}  // namespace sdm

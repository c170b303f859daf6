// Distances from a surface's samples to another body, for the samples that affect a result.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "proximity/sampled/body.h"
#include "surface/sample_blocks.h"

namespace sdm::sampled {

/// The samples are probed at a few of them: each bounds the distances of those around it, which are
/// 1-Lipschitz. What can still be within reach is probed more densely, down to single runs, and of the runs
/// that remain all samples are measured. A distance to the inside of a solid is negative. Culled samples are
/// never evaluated, so they cost almost nothing.
class LocalDistances {
 public:
  /// One probe for so many runs, at one density after the other. (Measured.)
  static constexpr std::array<std::size_t, 2> kRunsPerProbe{8, 1};

  /// Starts with all samples of `on`. The bodies must stay until these are measured.
  void start(const Body& on, const Body& to);
  /// Probes the remaining blocks, on all cores.
  void probe(std::size_t runs_per_probe);
  /// The least of the |distances| probed so far.
  [[nodiscard]] double least_probed() const { return least_probed_; }
  /// Keeps blocks that may be nearer than `reach` or inside.
  void keep(double reach);
  /// Measures all samples that are left, on all cores; they were last probed run by run.
  void measure();

  // The samples measured, run by run, in increasing order: their points, covering radii (see
  // Surface::sample_radii) and distances.
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }
  [[nodiscard]] std::span<const float> radii() const { return radii_; }
  [[nodiscard]] std::span<const float> distances() const { return distances_; }
  /// Which of the surface's samples the i-th one is.
  [[nodiscard]] std::size_t sample(std::size_t i) const;

 private:
  struct Probe {
    surface::RunRange runs;
    double distance = 0;
    double spread = 0;  ///< no sample of the runs, and no point that one covers, is farther from the probe
    /// No sample of the runs, and no point that it covers, is nearer.
    [[nodiscard]] double least() const { return distance - spread; }
  };
  void measure_runs(std::size_t begin, std::size_t end);

  const Body *on_ = nullptr, *to_ = nullptr;
  std::vector<Probe> probes_, denser_;
  std::vector<Vec3> probe_points_;
  double least_probed_ = 0;
  std::vector<Vec3> points_;
  std::vector<float> radii_, distances_;
};

}  // namespace sdm::sampled

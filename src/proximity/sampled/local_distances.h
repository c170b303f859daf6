// Distances from a surface's samples to another body, for the samples that affect a result.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "proximity/sampled/body.h"
#include "surface/sample_blocks.h"

namespace sdm::sampled {

/// The samples are probed at a few of them: each bounds the distances of those around it, which are
/// 1-Lipschitz. What can still be within reach is probed more densely, down to single blocks, and of the
/// blocks that remain all samples are measured. A distance to the inside of a solid is negative. Culled
/// samples are never evaluated, so they cost almost nothing.
class LocalDistances {
 public:
  /// One probe for so many blocks, at one density after the other. (Measured.)
  static constexpr std::array<std::size_t, 2> kBlocksPerProbe{8, 1};

  /// Starts with all samples of `on`. The bodies must stay until these are measured.
  void start(const Body& on, const Body& to);
  /// Probes the remaining blocks, on all cores.
  void probe(std::size_t blocks_per_probe);
  /// The least of the |distances| probed so far.
  [[nodiscard]] double least_probed() const { return least_probed_; }
  /// Keeps blocks that may be nearer than `reach` or inside.
  void keep(double reach);
  /// Measures all samples that are left, on all cores; they were last probed block by block.
  void measure();

  // The samples measured, block by block, in increasing order: their points, covering radii (see
  // SamplingBound::sample_radii) and distances.
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }
  [[nodiscard]] std::span<const float> radii() const { return radii_; }
  [[nodiscard]] std::span<const float> distances() const { return distances_; }
  /// Which of the surface's samples the i-th one is.
  [[nodiscard]] std::size_t sample(std::size_t i) const;

 private:
  struct Probe {
    surface::BlockRange blocks;
    double distance = 0;
    double radius = 0;  ///< of a ball about the probe that contains the blocks' samples and their pieces
    /// No sample of the blocks, and no point of its pieces, is nearer.
    [[nodiscard]] double least() const { return distance - radius; }
  };
  void measure_blocks(std::size_t begin, std::size_t end);

  const Body *on_ = nullptr, *to_ = nullptr;
  std::vector<Probe> probes_, denser_;
  std::vector<Vec3> probe_points_;
  double least_probed_ = 0;
  std::vector<Vec3> points_;
  std::vector<float> radii_, distances_;
};

}  // namespace sdm::sampled

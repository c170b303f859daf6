// Distances to another body from those samples of a surface that affect a result, in the frame of the other
// body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "mesh/similarity.h"
#include "proximity/shape/body.h"
#include "surface/sample_blocks.h"

namespace sdm::sampled {

/// Distances are 1-Lipschitz, so the distance at one sample, a probe, bounds those of the samples around it.
/// Ranges of blocks that may be within reach are probed more densely, down to single blocks; then all samples
/// of the remaining blocks are measured. Distances inside a solid are negative. Culled samples are never
/// evaluated, so they cost almost nothing.
class LocalDistances {
 public:
  /// Blocks per probe, for each pass of probing. (Measured.)
  static constexpr std::array<std::size_t, 2> kBlocksPerProbe{8, 1};

  /// Starts with all samples of `on`, moved by `pose` into the frame of `to`. The bodies must remain
  /// unchanged until they are measured.
  void start(const shape::Body& on, const shape::Body& to, const mesh::Similarity& pose);
  /// Probes the remaining blocks, on all cores.
  void probe(std::size_t blocks_per_probe);
  /// Keeps only blocks that may be nearer than `reach`, or inside.
  void keep(double reach);
  /// Measures all remaining samples, on all cores. The last probe() must have been with one block per probe.
  void measure();

  // The measured samples, block by block, in increasing order: their points, covering radii (see
  // SamplingBound::sample_radii) and distances.
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }
  [[nodiscard]] std::span<const float> radii() const { return radii_; }
  [[nodiscard]] std::span<const float> distances() const { return distances_; }
  /// The index on the surface of the i-th measured sample.
  [[nodiscard]] std::size_t sample(std::size_t i) const;

 private:
  struct Probe {
    surface::BlockRange blocks;
    double distance = 0;
    double radius = 0;  ///< of a ball around the probe that contains the blocks' samples and pieces
    /// Lower bound on the distance of any sample of the blocks and any point of their pieces.
    [[nodiscard]] double least() const { return distance - radius; }
  };
  void measure_blocks(std::size_t begin, std::size_t end);

  const shape::Body *on_ = nullptr, *to_ = nullptr;
  mesh::Similarity pose_;
  std::vector<Probe> probes_, denser_;
  std::vector<Vec3> probe_points_;
  std::vector<Vec3> points_;
  std::vector<float> radii_, distances_;
};

}  // namespace sdm::sampled

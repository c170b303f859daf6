// Distances to another body from those samples of a surface that affect a result, in the frame of the other
// body.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "proximity/sampled/body.h"
#include "proximity/similarity.h"
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
  void start(const Body& on, const Body& to, const proximity::Similarity& pose);
  /// Probes the remaining blocks, on all cores.
  void probe(std::size_t blocks_per_probe);
  /// The largest depth probed so far, or 0: a lower bound on the depth.
  [[nodiscard]] double deepest_probed() const { return deepest_probed_; }
  /// Marks the blocks that may have points deeper than `depth`, by the distance at the probe: the depth, as
  /// the distance to the boundary of a solid, is 1-Lipschitz. Blocks that were not marked before are not
  /// marked.
  void mark_deeper(double depth);
  /// Keeps only the marked blocks.
  void keep_marked();
  /// Keeps only blocks that may be nearer than `reach`, or inside.
  void keep(double reach);
  /// Which samples of the remaining blocks are measured.
  enum class Samples { marked, all };
  /// Marks, of the samples in marked blocks, those that may be deeper than `depth`, and measures these or all
  /// samples, on all cores. The last probe() must have been with one block per probe.
  void measure(double depth, Samples samples);

  // The samples of the remaining blocks, block by block, in increasing order: their points, covering radii
  // (see SamplingBound::sample_radii) and distances.
  [[nodiscard]] std::span<const Vec3> points() const { return points_; }
  [[nodiscard]] std::span<const float> radii() const { return radii_; }
  [[nodiscard]] std::span<const float> distances() const { return distances_; }
  /// Whether the i-th sample is marked. Samples that are not may have no distance: +∞.
  [[nodiscard]] bool marked(std::size_t i) const { return packet_marked_[i / kPacket]; }
  /// The marked samples inside a solid whose closest face may not be part of its
  /// boundary, because the solid intersects itself: the boundary may be farther away. In increasing order.
  [[nodiscard]] std::span<const std::uint32_t> buried() const { return buried_; }
  /// The index on the surface of the i-th measured sample.
  [[nodiscard]] std::size_t sample(std::size_t i) const;

 private:
  struct Probe {
    surface::BlockRange blocks;
    double distance = 0;
    double radius = 0;        ///< of a ball around the probe that contains the blocks' samples and pieces
    bool at_boundary = true;  ///< unless the probe is inside, and its closest face may not be of the boundary
    bool marked = true;
    /// Lower bound on the distance of any sample of the blocks and any point of their pieces.
    [[nodiscard]] double least() const { return distance - radius; }
  };
  /// Consecutive samples, compact as blocks are.
  static constexpr std::size_t kPacket = 16;

  /// Consecutive blocks, of the probes from `begin` to `end`.
  void measure_blocks(std::size_t begin, std::size_t end, double depth, Samples samples);
  void place_blocks(std::size_t begin, std::size_t end);
  void measure_samples(std::span<const std::uint32_t> samples);
  void mark_packets(std::size_t begin, std::size_t end, double depth);
  [[nodiscard]] std::size_t middle_of_packet(std::size_t packet) const {
    return (packet * kPacket + std::min(points_.size(), (packet + 1) * kPacket)) / 2;
  }
  [[nodiscard]] bool at_boundary(const Vec3& point, double distance, const sites::ClosestPacket& closest,
                                 std::size_t lane) const;

  const Body *on_ = nullptr, *to_ = nullptr;
  proximity::Similarity pose_;
  std::vector<Probe> probes_, denser_;
  std::vector<Vec3> probe_points_;
  double deepest_probed_ = 0;
  std::vector<Vec3> points_;
  std::vector<float> radii_, distances_;
  std::vector<std::uint8_t> at_boundary_;  // of each measured sample
  std::vector<std::uint8_t> packet_marked_;
  std::vector<std::uint32_t> buried_;
};

}  // namespace sdm::sampled

// Draws all pairs of the sites of O2 and a block of domains, in batches of bounded size.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "gl/pair_culling.h"
#include "gl/raster_report.h"

namespace sdm::gl {

/// Culls and clips on all cores while the canvas draws the previous batch. The order of drawing and all
/// counts depend only on the meshes. `Polygons` as for SiteDescent; canvas.draw(batch) draws a batch.
template <class Polygons, class Canvas>
class PairStream {
 public:
  /// All references must outlive it.
  PairStream(const SiteIndex& sites, const DomainTree& tree, const Polygons& polygons, Canvas& canvas,
             RasterReport::Times& time)
      : sites_(sites),
        tree_(tree),
        polygons_(polygons),
        canvas_(canvas),
        time_(time),
        parts_(kMostLeaves),
        counts_(kMostLeaves) {}

  /// `progress` receives the completed fraction of the block, and may throw.
  void draw(const DomainBlock& block, const std::function<void(double)>& progress) {
    Stopwatch watch;
    const std::vector<std::uint32_t> leaves = leaves_within_bound(sites_, tree_, block, total_);
    time_.cull += watch.lap();
    std::size_t at_once = kFirstLeaves;
    for (std::size_t begin = 0; begin < leaves.size();) {
      const std::size_t count = std::min(at_once, leaves.size() - begin);
      const std::uint64_t before = total_.polygons;
      cull(std::span(leaves).subspan(begin, count), block);
      draw_parts(count);
      const std::uint64_t made = total_.polygons - before;
      at_once = std::clamp(made > kBatchPolygons ? count / 2 : 2 * count, std::size_t{1}, kMostLeaves);
      begin += count;
      progress(static_cast<double>(begin) / static_cast<double>(leaves.size()));
    }
  }

  /// Submits the last batch to the device.
  void finish() {
    canvas_.draw(batch_);
    batch_.clear();
  }

  [[nodiscard]] const PairCounts& counts() const { return total_; }

 private:
  using Batch = typename Polygons::Batch;

  // The number of polygons that completes a batch.
  static constexpr std::size_t kBatchPolygons = 1 << 15;
  // Leaves of O2's tree processed at once: few at first, more as long as they produce no more than a batch.
  // Memory then rarely exceeds two batches; in the worst case, all sites of kMostLeaves leaves meet all
  // domains of a block.
  static constexpr std::size_t kFirstLeaves = 4, kMostLeaves = 64;

  void cull(std::span<const std::uint32_t> leaves, const DomainBlock& block) {
    Stopwatch watch;
    parallel_for(leaves.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        draw_leaf(sites_, leaves[i], tree_, block, polygons_, parts_[i], counts_[i]);
    });
    for (std::size_t i = 0; i < leaves.size(); ++i) total_ += std::exchange(counts_[i], {});
    time_.cull += watch.lap();
  }

  void draw_parts(std::size_t count) {
    Stopwatch watch;
    for (std::size_t i = 0; i < count; ++i) {
      batch_.append(parts_[i]);
      parts_[i].clear();
      if (batch_.size() >= kBatchPolygons) finish();
    }
    time_.draw += watch.lap();
  }

  const SiteIndex& sites_;
  const DomainTree& tree_;
  const Polygons& polygons_;
  Canvas& canvas_;
  RasterReport::Times& time_;
  std::vector<Batch> parts_;  ///< one for each leaf of O2's tree
  std::vector<PairCounts> counts_;
  Batch batch_;
  PairCounts total_;
};

}  // namespace sdm::gl

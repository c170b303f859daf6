// All pairs of a block of domains and the sites of O2, drawn in batches of bounded size.
#pragma once

#include <functional>
#include <vector>

#include "engine/gl/pair_culling.h"
#include "engine/gl/rasteriser.h"

namespace sdm::gl {

/// Culls and clips on all cores while the device draws the batch before. The order in which polygons are
/// drawn, and every count, depend on the meshes alone.
class PairStream {
 public:
  /// `reach` is the largest distance of interest. All references must outlive it.
  PairStream(const SiteIndex& sites, const DomainTree& tree, double reach, const RasterScale& scale,
             Rasteriser& rasteriser, GlReport::Times& time);

  /// `progress` receives the completed fraction of the block, and may throw.
  void draw(const DomainBlock& block, const std::function<void(double)>& progress);

  /// Submits the last batch to the device.
  void finish();

  [[nodiscard]] const PairCounts& counts() const { return total_; }

 private:
  void cull(std::span<const std::uint32_t> leaves, const DomainBlock& block);
  void draw_parts(std::size_t count);

  const SiteIndex& sites_;
  const DomainTree& tree_;
  double reach_;
  const RasterScale& scale_;
  Rasteriser& rasteriser_;
  GlReport::Times& time_;
  std::vector<RasterBatch> parts_;  ///< one a leaf of O2's tree
  std::vector<PairCounts> counts_;
  RasterBatch batch_;
  PairCounts total_;
};

}  // namespace sdm::gl

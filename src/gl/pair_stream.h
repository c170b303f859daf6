// Draws all pairs of the sites of O2 and a block of domains, in batches of bounded size.
#pragma once

#include <functional>
#include <vector>

#include "gl/pair_culling.h"
#include "gl/rasteriser.h"

namespace sdm::gl {

/// Culls and clips on all cores while the device draws the previous batch. The order of drawing and all
/// counts depend only on the meshes.
class PairStream {
 public:
  /// `reach`: the largest distance of interest. All references must outlive it.
  PairStream(const SiteIndex& sites, const DomainTree& tree, double reach, const RasterRules& rules,
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
  const RasterRules& rules_;
  Rasteriser& rasteriser_;
  GlReport::Times& time_;
  std::vector<RasterBatch> parts_;  ///< one for each leaf of O2's tree
  std::vector<PairCounts> counts_;
  RasterBatch batch_;
  PairCounts total_;
};

}  // namespace sdm::gl

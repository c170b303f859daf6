// The nearest sample of a surface to a point in space.
#pragma once

#include <sdm/surface.h>

#include <vector>

#include "geometry/unit_frame.h"
#include "surface/surface_data.h"
#include "tree/aabb_tree.h"

namespace sdm::surface {

/// A tree over runs of consecutive samples, which are close together: it is built in a fraction of the time
/// of a tree over single samples, and takes less memory. The surface must have a sample, outlive the tree and
/// remain unchanged.
class SampleTree {
 public:
  /// Runs stay within `radius` of their first sample: a few texels, so that a run that jumps to another place
  /// is cut. Cost: linear in samples, all cores.
  SampleTree(const Surface& surface, double radius);

  /// The nearest sample, as an index into sample_texels(). Cost: O(log n) for queries near the surface.
  [[nodiscard]] std::uint32_t nearest(const Vec3& query) const;

 private:
  struct Run;
  [[nodiscard]] std::vector<Run> cut(std::size_t begin, std::size_t end, double radius) const;

  const SurfaceData& surface_;
  UnitFrame frame_;
  std::vector<std::size_t> first_;  ///< sample of each run, and the end of the last run
  tree::AabbTree tree_;             ///< over runs, one a leaf
};

}  // namespace sdm::surface

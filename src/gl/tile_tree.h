// An AABB tree over the tiles of a surface, and a cache of such trees.
#pragma once

#include <map>
#include <memory>

#include "surface/surface_data.h"
#include "surface/tiles.h"
#include "tree/aabb_tree.h"

namespace sdm::gl {

struct TileTree {
  /// Cost: O(n log n) in tiles, linear in texels, all cores.
  explicit TileTree(const Surface& surface, std::uint32_t side = surface::Tiles::kSide);

  surface::Tiles tiles;
  tree::AabbTree tree;  ///< one tile per leaf; its boxes are those of the shape it was built for
};

/// The trees of surfaces that are mapped repeatedly, as in a sequence: building one takes longer than drawing
/// a map of a small mesh. Entries of surfaces that no longer exist are dropped at the next call.
class TileTreeCache {
 public:
  /// `side` of the tiles, in texels.
  explicit TileTreeCache(std::uint32_t side = surface::Tiles::kSide) : side_(side) {}

  /// Returns the tree of a surface, built on the first call. Valid until the next call.
  [[nodiscard]] const TileTree& of(const Surface& surface);

 private:
  std::uint32_t side_;
  std::map<std::weak_ptr<const surface::Identity>, TileTree, std::owner_less<>> trees_;
};

}  // namespace sdm::gl

#include "gl/tile_tree.h"

#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "geometry/unit_frame.h"
#include "geometry/vec.h"

namespace sdm::gl {
namespace {

constexpr std::size_t kTileGrain = 512;  // tiles

tree::AabbTree build_tree(const Surface& surface, const surface::Tiles& tiles) {
  const UnitFrame frame = UnitFrame::of(bounds(surface.mesh()));
  std::vector<Box> boxes(tiles.count());
  parallel_for(boxes.size(), kTileGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile)
      for (const std::uint32_t texel : tiles.of(static_cast<std::uint32_t>(tile)))
        extend(boxes[tile], frame.to_unit(surface.texel_point(texel)));
  });
  std::vector<std::uint32_t> items(tiles.count());
  std::iota(items.begin(), items.end(), 0u);
  return tree::build_aabb_tree(boxes, std::move(items), 1);
}

}  // namespace

TileTree::TileTree(const Surface& surface, std::uint32_t side)
    : tiles(surface, surface.texel_faces(), side), tree(build_tree(surface, tiles)) {}

const TileTree& TileTreeCache::of(const Surface& surface) {
  std::erase_if(trees_, [](const auto& entry) { return entry.first.expired(); });
  return trees_.try_emplace(internals(surface).identity, surface, side_).first->second;
}

}  // namespace sdm::gl

// The faces of a surface in tiles, small in the atlas and so in space, under an AABB tree.
#pragma once

#include <sdm/surface.h>

#include <vector>

#include "hierarchy/aabb_tree.h"

namespace sdm::surface {

/// A tile holds texels of one face in a square of kSide texels; most faces are one tile.
struct Tiles {
  static constexpr std::uint32_t kSide = 16;

  std::vector<std::uint32_t> texels;        ///< owned texels, face after face, tile after tile
  std::vector<std::uint32_t> face_offsets;  ///< texels of each face of the mesh, and the end
  std::vector<std::uint32_t> offsets;       ///< texels of each tile, and the end
  std::vector<std::uint32_t> faces;         ///< of each tile
  hierarchy::AabbTree tree;                 ///< one tile a leaf; its boxes are those of the first call

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(faces.size()); }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t tile) const {
    return {texels.data() + offsets[tile], texels.data() + offsets[tile + 1]};
  }
};

/// The tiles of a surface, made at the first call. Engines copy the tree and refit it in the frame they work
/// in. Cost: O(n log n) in texels and tiles, then none.
[[nodiscard]] const Tiles& tiles_of(const Surface& surface);

}  // namespace sdm::surface

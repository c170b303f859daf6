// The faces of a surface divided into tiles, which are small in the atlas and therefore in space.
#pragma once

#include <sdm/surface.h>

#include <vector>

namespace sdm::surface {

/// A tile holds texels of one face in a square of `side` texels; most faces are one tile. Refits do not
/// change them.
struct Tiles {
  static constexpr std::uint32_t kSide = 16;

  /// Cost: linear in texels, plus sorting those of faces with more than one tile; all cores.
  explicit Tiles(const Surface& surface, std::uint32_t side = kSide);

  std::vector<std::uint32_t> texels;        ///< owned texels, by face, then by tile
  std::vector<std::uint32_t> face_offsets;  ///< texels of each face of the mesh, and the end
  std::vector<std::uint32_t> offsets;       ///< texels of each tile, and the end
  std::vector<std::uint32_t> faces;         ///< of each tile

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(faces.size()); }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t tile) const {
    return {texels.data() + offsets[tile], texels.data() + offsets[tile + 1]};
  }
};

}  // namespace sdm::surface

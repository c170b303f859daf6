// The faces of a surface divided into tiles, which are small in the atlas and therefore in space.
#pragma once

#include <sdm/surface.h>

#include <vector>

namespace sdm::surface {

/// A tile holds samples of one face: texels in a square of `side` texels, or the one of a face without a
/// texel; most faces are one tile. Refits do not change them.
struct Tiles {
  static constexpr std::uint32_t kSide = 16;

  /// The tiles of all samples. Cost: linear in texels, plus sorting those of faces with more than one tile;
  /// all cores.
  explicit Tiles(const Surface& surface) : Tiles(surface, surface.map_faces(), kSide) {}
  /// `owners`: texel_faces() of the surface, for tiles of texels only, or map_faces().
  Tiles(const Surface& surface, std::span<const std::uint32_t> owners, std::uint32_t side);

  std::vector<std::uint32_t> texels;        ///< samples, by face, then by tile
  std::vector<std::uint32_t> face_offsets;  ///< texels of each face of the mesh, and the end
  std::vector<std::uint32_t> offsets;       ///< texels of each tile, and the end
  std::vector<std::uint32_t> faces;         ///< of each tile

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(faces.size()); }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t tile) const {
    return {texels.data() + offsets[tile], texels.data() + offsets[tile + 1]};
  }
};

}  // namespace sdm::surface

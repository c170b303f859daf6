#include "surface/tiles.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"

namespace sdm::surface {
namespace {

constexpr std::size_t kGrain = 512;  // faces or tiles

// Sorts the samples by face, those of a face from the top left.
void sort_by_face(std::span<const std::uint32_t> owners, std::size_t faces, Tiles& tiles) {
  tiles.face_offsets.assign(faces + 1, 0);
  for (const std::uint32_t face : owners)
    if (face != kNone) ++tiles.face_offsets[face + 1];
  std::partial_sum(tiles.face_offsets.begin(), tiles.face_offsets.end(), tiles.face_offsets.begin());
  tiles.texels.resize(tiles.face_offsets.back());
  std::vector<std::uint32_t> next(tiles.face_offsets.begin(), tiles.face_offsets.end() - 1);
  for (std::uint32_t texel = 0; texel < owners.size(); ++texel)
    if (owners[texel] != kNone) tiles.texels[next[owners[texel]]++] = texel;
}

// The squares of a face's bounding rectangle, and which of them contains a texel.
struct TileGrid {
  std::uint32_t resolution, side, left = kNone, top = kNone, right = 0;

  TileGrid(std::uint32_t n, std::uint32_t s, std::span<const std::uint32_t> texels)
      : resolution(n), side(s), top(texels.front() / n) {
    for (const std::uint32_t texel : texels) {
      left = std::min(left, texel % n);
      right = std::max(right, texel % n);
    }
  }
  [[nodiscard]] std::uint32_t operator()(std::uint32_t texel) const {
    const std::uint32_t columns = (right - left) / side + 1;
    return (texel / resolution - top) / side * columns + (texel % resolution - left) / side;
  }
};

void cut(const Surface& surface, std::uint32_t side, Tiles& tiles) {
  const std::size_t face_count = surface.mesh().triangles.size();
  std::vector<std::uint32_t> tile_of(tiles.texels.size());  // within its face
  parallel_for(face_count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) {
      const std::uint32_t first = tiles.face_offsets[face], last = tiles.face_offsets[face + 1];
      if (first == last) continue;
      const std::span<std::uint32_t> texels(tiles.texels.data() + first, last - first);
      const TileGrid grid(surface.resolution(), side, texels);
      std::ranges::stable_sort(texels, {}, grid);
      std::ranges::transform(texels, tile_of.begin() + first, grid);
    }
  });
  for (std::uint32_t face = 0; face < face_count; ++face)
    for (std::uint32_t i = tiles.face_offsets[face]; i < tiles.face_offsets[face + 1]; ++i)
      if (i == tiles.face_offsets[face] || tile_of[i] != tile_of[i - 1]) {
        tiles.offsets.push_back(i);
        tiles.faces.push_back(face);
      }
  tiles.offsets.push_back(static_cast<std::uint32_t>(tiles.texels.size()));
}

}  // namespace

Tiles::Tiles(const Surface& surface, std::span<const std::uint32_t> owners, std::uint32_t side) {
  sort_by_face(owners, surface.mesh().triangles.size(), *this);
  cut(surface, side, *this);
}

}  // namespace sdm::surface

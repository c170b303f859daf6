// Values for the free texels around charts, so that filtering at a chart's border does not blend in the
// background.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::atlas {

/// How far, in texels, values extend beyond the charts at least: bilinear filtering needs 1, the rest is for
/// smaller mip levels.
inline constexpr std::uint32_t kGutter = 4;

/// The owned texels from which free ones take their values.
class Gutter {
 public:
  /// `owners`: whole rows of `resolution` values, kNone for a free texel; they must outlive this and not
  /// change. Values extend `width` ≥ 1 rings of texels beyond the owned ones. Distances are those of rings,
  /// as those between charts are: of charts that are 2 · width apart, a square of width² texels that meets
  /// one has its values only, so that no mipmap down to the side `width` mixes them.
  Gutter(std::uint32_t resolution, std::span<const std::uint32_t> owners, std::uint32_t width = kGutter);

  /// The owned texel nearest to (x, y), of those of one ring the one at the least distance: the texel itself
  /// if it is owned; kNone if there is none within `width` rings.
  [[nodiscard]] std::uint32_t source(std::uint32_t x, std::uint32_t y) const {
    const std::size_t texel = std::size_t{y} * resolution_ + x;
    if (owners_[texel] != kNone) return static_cast<std::uint32_t>(texel);
    return close_[std::size_t{y >> shift_} * blocks_ + (x >> shift_)] ? search(x, y) : kNone;
  }

 private:
  [[nodiscard]] std::uint32_t search(std::uint32_t x, std::uint32_t y) const;

  std::uint32_t resolution_, rows_;  ///< texels per row and per column
  unsigned shift_;        ///< the binary logarithm of the side of a block, which is at least the width
  std::uint32_t blocks_;  ///< per row
  std::vector<std::array<int, 2>> steps_;  ///< all offsets within `width` rings, nearest first
  std::span<const std::uint32_t> owners_;
  /// Whether each block, or one of the eight around it, has an owned texel.
  std::vector<std::uint8_t> close_;
};

}  // namespace sdm::atlas

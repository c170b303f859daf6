// Values for the free texels around charts, so that filtering at a chart's border does not blend in the
// background.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "core/parallel.h"

namespace sdm::atlas {

/// How far, in texels, values extend beyond the charts at least: bilinear filtering needs 1, the rest is for
/// smaller mip levels.
inline constexpr std::uint32_t kGutter = 4;

/// The owned texels from which free ones take their values.
class Gutter {
 public:
  /// `owners`: whole rows of `resolution` values, kNone for a free texel. Values extend `width` ≥ 1 rings of
  /// texels beyond the owned ones. Distances are those of rings, as those between charts are: of charts that
  /// are 2 · width apart, a square of width² texels that meets one has its values only, so that no mipmap
  /// down to the side `width` mixes them.
  Gutter(std::uint32_t resolution, std::span<const std::uint32_t> owners, std::uint32_t width = kGutter)
      : Gutter(
            resolution, owners.size() / resolution, [&](std::size_t i) { return owners[i] != kNone; },
            width) {}
  /// `owned`: whether a texel is owned, by its number; called concurrently by the constructor only.
  template <class Owned>
  Gutter(std::uint32_t resolution, std::size_t rows, const Owned& owned, std::uint32_t width)
      : Gutter(resolution, rows, width) {
    constexpr std::size_t kRows = 16;
    parallel_for(rows, kRows, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y) find_along_row(y, owned);
    });
    find_blocks();
  }

  /// The owned texel nearest to (x, y), of those of one ring the one at the least distance, of these the
  /// first in the order of rows: the texel itself if it is owned; kNone if there is none within `width`
  /// rings. Cost: of a free texel near owned ones, linear in `width`.
  [[nodiscard]] std::uint32_t source(std::uint32_t x, std::uint32_t y) const {
    const std::size_t texel = std::size_t{y} * resolution_ + x;
    if (along_row_[texel] == 0) return static_cast<std::uint32_t>(texel);
    return close_[std::size_t{y >> shift_} * blocks_ + (x >> shift_)] ? search(x, y) : kNone;
  }

 private:
  Gutter(std::uint32_t resolution, std::size_t rows, std::uint32_t width);
  /// Sets along_row_ of a row.
  template <class Owned>
  void find_along_row(std::size_t row, const Owned& owned) {
    const int none = width_ + 1;
    const std::size_t first = row * resolution_;
    int to_left = none, to_right = none;
    for (std::size_t i = first; i < first + resolution_; ++i) {
      to_left = owned(i) ? 0 : std::min(to_left + 1, none);
      along_row_[i] = static_cast<std::int16_t>(to_left < none ? -to_left : none);
    }
    for (std::size_t i = first + resolution_; i-- > first;) {
      to_right = along_row_[i] == 0 ? 0 : std::min(to_right + 1, none);
      if (to_right < std::abs(along_row_[i])) along_row_[i] = static_cast<std::int16_t>(to_right);
    }
  }
  void find_blocks();
  [[nodiscard]] std::uint32_t search(std::uint32_t x, std::uint32_t y) const;

  std::uint32_t resolution_, rows_;  ///< texels per row and per column
  unsigned shift_;        ///< the binary logarithm of the side of a block, which is at least the width
  std::uint32_t blocks_;  ///< per row
  int width_;
  /// The number of columns to the nearest owned texel of the same row, of two the one on the left; more than
  /// `width` if there is none.
  std::vector<std::int16_t> along_row_;
  /// Whether each block, or one of the eight around it, has an owned texel.
  std::vector<std::uint8_t> close_;
};

}  // namespace sdm::atlas

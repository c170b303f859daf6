#include "atlas/gutter.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace sdm::atlas {
namespace {

constexpr std::uint32_t kWidest = 1 << 14;  // so that columns fit 16 bits

}  // namespace

Gutter::Gutter(std::uint32_t resolution, std::size_t rows, std::uint32_t width)
    : resolution_(resolution),
      rows_(static_cast<std::uint32_t>(rows)),
      shift_(static_cast<unsigned>(std::bit_width(std::bit_ceil(width)) - 1)),
      blocks_(((resolution - 1) >> shift_) + 1),
      width_(static_cast<int>(std::min(width, kWidest))),
      along_row_(rows * resolution) {}

void Gutter::find_blocks() {
  const std::uint32_t side = 1u << shift_, block_rows = ((rows_ - 1) >> shift_) + 1;
  std::vector<std::uint8_t> owned(std::size_t{block_rows} * blocks_);
  close_.resize(owned.size());
  constexpr std::size_t kGrain = 16;  // rows of blocks
  parallel_for(block_rows, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin * side; y < std::min<std::size_t>(end * side, rows_); ++y)
      for (std::size_t x = 0; x < resolution_; ++x)
        owned[(y >> shift_) * blocks_ + (x >> shift_)] |= along_row_[y * resolution_ + x] == 0;
  });
  parallel_for(block_rows, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (std::size_t column = 0; column < blocks_; ++column)
        for (std::size_t y = row - (row > 0); y <= std::min<std::size_t>(row + 1, block_rows - 1); ++y)
          for (std::size_t x = column - (column > 0); x <= std::min<std::size_t>(column + 1, blocks_ - 1);
               ++x)
            close_[row * blocks_ + column] |= owned[y * blocks_ + x];
  });
}

std::uint32_t Gutter::search(std::uint32_t x, std::uint32_t y) const {
  // The nearest texel of a row is the nearest one along it. Rows are visited from the nearest on, until they
  // are farther than a ring with an owned texel.
  int ring = width_ + 1, squared = 0, best_row = 0;
  std::uint32_t best = kNone;
  const auto visit = [&](int dy) {
    const std::uint32_t row = y + static_cast<std::uint32_t>(dy);  // above the image, a large number
    if (row >= rows_) return;
    const std::size_t texel = std::size_t{row} * resolution_ + x;
    const int dx = along_row_[texel], its_ring = std::max(std::abs(dx), std::abs(dy));
    if (its_ring > std::min(ring, width_)) return;
    const int its_squared = dx * dx + dy * dy;
    if (its_ring == ring && (its_squared > squared || (its_squared == squared && dy > best_row))) return;
    ring = its_ring;
    squared = its_squared;
    best_row = dy;
    best = static_cast<std::uint32_t>(static_cast<std::int64_t>(texel) + dx);
  };
  for (int dy = 0; dy <= std::min(ring, width_); ++dy) {
    visit(-dy);
    if (dy > 0) visit(dy);
  }
  return best;
}

}  // namespace sdm::atlas

#include "atlas/gutter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "core/parallel.h"

namespace sdm::atlas {
namespace {

// The order in which the nearest texel is searched: by rings, and within a ring by length.
std::array<int, 2> rank_of(const std::array<int, 2>& step) {
  const auto [dx, dy] = step;
  return {std::max(std::abs(dx), std::abs(dy)), dx * dx + dy * dy};
}

// All offsets within so many rings, nearest first; of equal ones, those along rows first.
std::vector<std::array<int, 2>> steps_within(int rings) {
  std::vector<std::array<int, 2>> steps;
  for (int dy = -rings; dy <= rings; ++dy)
    for (int dx = -rings; dx <= rings; ++dx) steps.push_back({dx, dy});
  std::ranges::stable_sort(steps, {}, rank_of);
  return steps;
}

}  // namespace

Gutter::Gutter(std::uint32_t resolution, std::span<const std::uint32_t> owners, std::uint32_t width)
    : resolution_(resolution),
      rows_(static_cast<std::uint32_t>(owners.size() / resolution)),
      shift_(static_cast<unsigned>(std::bit_width(std::bit_ceil(width)) - 1)),
      blocks_(((resolution - 1) >> shift_) + 1),
      steps_(steps_within(static_cast<int>(width))),
      owners_(owners) {
  const std::uint32_t side = 1u << shift_, block_rows = ((rows_ - 1) >> shift_) + 1;
  std::vector<std::uint8_t> owned(std::size_t{block_rows} * blocks_);
  close_.resize(owned.size());
  constexpr std::size_t kGrain = 16;  // rows of blocks
  parallel_for(block_rows, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin * side; y < std::min<std::size_t>(end * side, rows_); ++y)
      for (std::size_t x = 0; x < resolution_; ++x)
        owned[(y >> shift_) * blocks_ + (x >> shift_)] |= owners_[y * resolution_ + x] != kNone;
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
  for (const auto& [dx, dy] : steps_) {
    // Offsets out of the image wrap around to large numbers.
    const std::uint32_t sx = x + static_cast<std::uint32_t>(dx), sy = y + static_cast<std::uint32_t>(dy);
    if (sx >= resolution_ || sy >= rows_) continue;
    const std::size_t source = std::size_t{sy} * resolution_ + sx;
    if (owners_[source] != kNone) return static_cast<std::uint32_t>(source);
  }
  return kNone;
}

}  // namespace sdm::atlas

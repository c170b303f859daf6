#include "io/write/gutter.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"

namespace sdm::io {
namespace {

// All offsets within a disc, shortest first; of equal lengths, those along rows first.
std::vector<std::array<int, 2>> disc() {
  constexpr int kRadius = kGutter;
  std::vector<std::array<int, 2>> steps;
  for (int dy = -kRadius; dy <= kRadius; ++dy)
    for (int dx = -kRadius; dx <= kRadius; ++dx)
      if (dx * dx + dy * dy <= kRadius * kRadius) steps.push_back({dx, dy});
  std::stable_sort(steps.begin(), steps.end(), [](const auto& a, const auto& b) {
    return a[0] * a[0] + a[1] * a[1] < b[0] * b[0] + b[1] * b[1];
  });
  return steps;
}

}  // namespace

Gutter::Gutter(std::uint32_t resolution, std::span<const std::uint32_t> owners)
    : resolution_(resolution),
      rows_(static_cast<std::uint32_t>(owners.size() / resolution)),
      blocks_((resolution + kGutter - 1) / kGutter),
      owners_(owners) {
  const std::uint32_t block_rows = (rows_ + kGutter - 1) / kGutter;
  std::vector<std::uint8_t> owned(std::size_t{block_rows} * blocks_);
  close_.resize(owned.size());
  constexpr std::size_t kGrain = 16;  // rows of blocks
  parallel_for(block_rows, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin * kGutter; y < std::min<std::size_t>(end * kGutter, rows_); ++y)
      for (std::size_t x = 0; x < resolution_; ++x)
        owned[y / kGutter * blocks_ + x / kGutter] |= owners_[y * resolution_ + x] != kNone;
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
  static const auto steps = disc();
  for (const auto& [dx, dy] : steps) {
    // Offsets out of the image wrap around to large numbers.
    const std::uint32_t sx = x + static_cast<std::uint32_t>(dx), sy = y + static_cast<std::uint32_t>(dy);
    if (sx >= resolution_ || sy >= rows_) continue;
    const std::size_t source = std::size_t{sy} * resolution_ + sx;
    if (owners_[source] != kNone) return static_cast<std::uint32_t>(source);
  }
  return kNone;
}

}  // namespace sdm::io

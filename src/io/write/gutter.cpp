#include "io/write/gutter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace sdm::io {
namespace {

// All offsets within a disc, shortest first; of equal lengths, those along rows first.
std::vector<std::array<int, 2>> disc() {
  std::vector<std::array<int, 2>> steps;
  for (int dy = -kGutter; dy <= kGutter; ++dy)
    for (int dx = -kGutter; dx <= kGutter; ++dx)
      if (dx * dx + dy * dy <= kGutter * kGutter) steps.push_back({dx, dy});
  std::stable_sort(steps.begin(), steps.end(), [](const auto& a, const auto& b) {
    return a[0] * a[0] + a[1] * a[1] < b[0] * b[0] + b[1] * b[1];
  });
  return steps;
}

}  // namespace

std::uint32_t gutter_source(std::uint32_t resolution, std::span<const std::uint32_t> owners, std::uint32_t x,
                            std::uint32_t y) {
  static const auto steps = disc();
  for (const auto& [dx, dy] : steps) {
    // Offsets out of the image wrap around to large numbers.
    const std::uint32_t sx = x + static_cast<std::uint32_t>(dx), sy = y + static_cast<std::uint32_t>(dy);
    if (sx >= resolution || sy >= resolution) continue;
    const std::size_t source = std::size_t{sy} * resolution + sx;
    if (owners[source] != kNone) return static_cast<std::uint32_t>(source);
  }
  return kNone;
}

}  // namespace sdm::io

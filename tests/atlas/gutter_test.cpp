// The texels that free ones of an atlas take their values from.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <tuple>
#include <vector>

#include "atlas/gutter.h"

namespace sdm::test {
namespace {

/// By comparing all owned texels: the nearest by rings, then by distance, then in the order of rows.
std::uint32_t nearest_owned(std::uint32_t resolution, const std::vector<std::uint32_t>& owners, int x, int y,
                            int width) {
  std::tuple<int, int, std::uint32_t> best{width + 1, 0, kNone};
  for (std::uint32_t texel = 0; texel < owners.size(); ++texel) {
    if (owners[texel] == kNone) continue;
    const int dx = static_cast<int>(texel % resolution) - x, dy = static_cast<int>(texel / resolution) - y;
    const int ring = std::max(std::abs(dx), std::abs(dy));
    if (ring <= width) best = std::min(best, {ring, dx * dx + dy * dy, texel});
  }
  return std::get<2>(best);
}

TEST(Gutter, HasTheNearestOwnedTexel) {
  std::mt19937 random(3);
  constexpr std::uint32_t kColumns = 37, kRows = 23;
  for (const std::uint32_t width : {1u, 3u, 4u, 9u, 40u})
    for (const double share : {0.0, 0.004, 0.05, 0.5}) {
      std::vector<std::uint32_t> owners(kColumns * kRows, kNone);
      for (std::uint32_t& owner : owners)
        if (std::bernoulli_distribution(share)(random)) owner = 7;
      const atlas::Gutter gutter(kColumns, owners, width);
      for (std::uint32_t y = 0; y < kRows; ++y)
        for (std::uint32_t x = 0; x < kColumns; ++x)
          ASSERT_EQ(gutter.source(x, y), nearest_owned(kColumns, owners, static_cast<int>(x),
                                                       static_cast<int>(y), static_cast<int>(width)))
              << x << ' ' << y << ", width " << width << ", share " << share;
    }
}

}  // namespace
}  // namespace sdm::test

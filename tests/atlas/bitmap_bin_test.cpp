#include "atlas/packing/bitmap_bin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sdm {
namespace {

using Cells = std::vector<std::vector<bool>>;

atlas::Stamp random_stamp(std::mt19937& random, std::uint32_t largest) {
  const auto below = [&](std::uint32_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(random);
  };
  atlas::Stamp stamp{1 + below(largest), 1 + below(largest), {}};
  for (std::uint32_t r = 0; r < stamp.height; ++r)
    for (std::uint32_t x = below(stamp.width); x < stamp.width; x += below(stamp.width) + 2) {
      const std::uint32_t length = 1 + below(stamp.width - x);
      stamp.runs.push_back({r, x, length});
      x += length;
    }
  return stamp;
}

bool is_free(const Cells& cells, const atlas::Stamp& stamp, std::uint32_t x, std::uint32_t y) {
  return std::ranges::none_of(stamp.runs, [&](const atlas::Run& run) {
    const auto row = cells[y + run.row].begin() + x + run.begin;
    return std::find(row, row + run.length, true) != row + run.length;
  });
}

// Row by row, cell by cell.
std::optional<atlas::BitmapBin::Spot> plain_first_fit(const Cells& cells, const atlas::Stamp& stamp,
                                                      std::uint32_t first_y, std::uint32_t end_y) {
  for (std::uint32_t y = first_y; y < end_y && y + stamp.height <= cells.size(); ++y)
    for (std::uint32_t x = 0; x + stamp.width <= cells[y].size(); ++x)
      if (is_free(cells, stamp, x, y)) return atlas::BitmapBin::Spot{x, y};
  return std::nullopt;
}

TEST(BitmapBin, FindsTheFirstFit) {
  for (const std::uint32_t size : {16u, 63u, 64u, 65u, 100u, 128u, 200u}) {
    SCOPED_TRACE(size);
    std::mt19937 random(size);
    const std::uint32_t height = size + size / 3;
    atlas::BitmapBin bin(size, height);
    Cells cells(height, std::vector<bool>(size, false));
    int misses = 0;
    for (int i = 0; i < 600; ++i) {
      const atlas::Stamp stamp = random_stamp(random, i < 300 ? size / 4 : 6);
      const std::uint32_t first_y = i % 5 == 0 ? size / 3 : 0, end_y = i % 7 == 0 ? size / 2 : height;
      const auto expected = plain_first_fit(cells, stamp, first_y, end_y);
      const auto spot = bin.first_fit(stamp, first_y, end_y);
      ASSERT_EQ(spot.has_value(), expected.has_value()) << i;
      misses += !spot;
      if (!spot) continue;
      ASSERT_EQ(spot->x, expected->x) << i;
      ASSERT_EQ(spot->y, expected->y) << i;
      bin.place(stamp, *spot);
      for (const atlas::Run& run : stamp.runs)
        std::fill_n(cells[spot->y + run.row].begin() + spot->x + run.begin, run.length, true);
    }
    EXPECT_GT(misses, 50);
  }
}

TEST(BitmapBin, FitsStampsUpToItsOwnSize) {
  atlas::BitmapBin bin(64, 3);
  atlas::Stamp stamp{64, 3, {{0, 0, 64}, {1, 0, 64}, {2, 0, 64}}};
  EXPECT_TRUE(bin.first_fit(stamp, 0, 64));
  stamp.width = 65;
  EXPECT_FALSE(bin.first_fit(stamp, 0, 64));
  stamp.width = 64;
  stamp.height = 4;
  EXPECT_FALSE(bin.first_fit(stamp, 0, 64));
}

}  // namespace
}  // namespace sdm

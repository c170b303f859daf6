#include "atlas/packing/rasterise.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

namespace sdm {
namespace {

// Vertices at halves of texels, so that many centres lie on edges and corners: each centre within the
// square still belongs to exactly one triangle, in either orientation.
TEST(Rasterise, SharedEdgesGiveEachCentreToOneTriangle) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    std::uniform_int_distribution<int> inner(1, 39);
    const Vec2 apex = {inner(random) / 2.0, inner(random) / 2.0};
    std::vector<Vec2> rim;
    for (int i = 0; i < 20; i += 1 + inner(random) % 7) rim.push_back({1.0 * i, 0});
    for (int i = 0; i < 20; i += 1 + inner(random) % 7) rim.push_back({20, 1.0 * i});
    for (int i = 20; i > 0; i -= 1 + inner(random) % 7) rim.push_back({1.0 * i, 20});
    for (int i = 20; i > 0; i -= 1 + inner(random) % 7) rim.push_back({0, 1.0 * i});
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> owners;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      std::array<Vec2, 3> t = {apex, rim[i], rim[(i + 1) % rim.size()]};
      if (random() % 2) std::swap(t[0], t[2]);
      atlas::for_each_centre(t, [&](std::uint32_t x, std::uint32_t y) { ++owners[{x, y}]; });
    }
    ASSERT_EQ(owners.size(), 400u);
    for (const auto& [texel, count] : owners) ASSERT_EQ(count, 1) << texel.first << ' ' << texel.second;
  }
}

TEST(Rasterise, TrianglesWithoutAreaOwnNothing) {
  atlas::for_each_centre({Vec2{0.5, 0.5}, Vec2{3.5, 3.5}, Vec2{2.5, 2.5}}, [](auto, auto) { FAIL(); });
  atlas::for_each_centre({Vec2{0.5, 0.5}, Vec2{0.5, 0.5}, Vec2{0.5, 0.5}}, [](auto, auto) { FAIL(); });
}

}  // namespace
}  // namespace sdm

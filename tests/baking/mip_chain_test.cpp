// Filtered pictures.
#include "baking/mip_chain.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace sdm::test {
namespace {

// Columns of black and white: samples close to each other across the place see one of them, at any length.
TEST(MipChain, ALongPlaceKeepsWhatVariesAcrossIt) {
  constexpr std::uint32_t kSize = 64;
  Image stripes{.width = kSize, .height = kSize, .components = 1, .bytes = {}};
  stripes.bytes.resize(std::size_t{kSize} * kSize);
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) stripes.bytes[y * kSize + x] = x / 4 % 2 == 0 ? 255 : 0;
  const baking::MipChain chain(stripes, false);
  const Vec2 along{0, 50}, across{1, 0};
  for (const bool first : {true, false}) {
    const auto mean = [&](double x) {
      return chain.mean({.centre = {x, kSize / 2.0},
                         .sides = {first ? along : across, first ? across : along},
                         .wrap = {}})[0];
    };
    EXPECT_NEAR(mean(34), 1, 1e-3) << first;
    EXPECT_NEAR(mean(38), 0, 1e-3) << first;
  }
}

}  // namespace
}  // namespace sdm::test

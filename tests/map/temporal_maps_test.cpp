#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/statistics.h>

#include <cmath>
#include <vector>

#include "support/made_up_maps.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

TEST(Temporal, ComputesMinimumMeanAndMaximum) {
  const Surface surface(ring(12), {.resolution = 64});
  TemporalMaps maps;
  const auto field = [](int t) {
    return [t](const Vec3& p) { return p[0] + std::cos(t * p[1]) * p[2] + t % 3; };
  };
  std::vector<DistanceMap> all;
  for (int t = 0; t < 7; ++t) {
    all.push_back(map_of(surface, field(t)));
    maps.add(all.back());
  }
  EXPECT_EQ(maps.maps(), 7u);
  const std::vector<float> mean = maps.mean();
  for (std::uint32_t texel = 0; texel < mean.size(); ++texel) {
    double least = 1e300, largest = -1e300, sum = 0;
    for (const DistanceMap& map : all) {
      const double d = map.distance[texel];
      least = std::fmin(least, d);
      largest = std::fmax(largest, d);
      sum += d;
    }
    if (surface.map_faces()[texel] == kNone) {
      ASSERT_TRUE(std::isnan(maps.least()[texel]) && std::isnan(maps.largest()[texel]) &&
                  std::isnan(mean[texel]));
      continue;
    }
    ASSERT_EQ(maps.least()[texel], least);
    ASSERT_EQ(maps.largest()[texel], largest);
    ASSERT_NEAR(mean[texel], sum / 7, 1e-6);
  }
}

// For any order of the maps.
TEST(Temporal, TexelsThatLackedAValueHaveNone) {
  const Surface surface(ring(12), {.resolution = 32});
  for (const int missing : {0, 1, 2}) {
    TemporalMaps maps;
    for (int t = 0; t < 3; ++t)
      maps.add(
          map_of(surface, [&](const Vec3& p) { return t == missing && p[0] > 0 ? std::nan("") : 1.0 + t; }));
    for (const std::uint32_t texel : surface.sample_texels()) {
      if (texel >= maps.least().size()) continue;  // of a face without a texel
      const bool none = surface.texel_point(texel)[0] > 0;
      ASSERT_EQ(std::isnan(maps.least()[texel]), none);
      ASSERT_EQ(std::isnan(maps.largest()[texel]), none);
      ASSERT_EQ(std::isnan(maps.mean()[texel]), none);
    }
  }
}

TEST(Temporal, NothingInRangeIsInfinitelyFar) {
  const Surface surface(ring(12), {.resolution = 32});
  for (const int missing : {0, 1, 2}) {
    TemporalMaps maps;
    for (int t = 0; t < 3; ++t)
      maps.add(map_of(surface, [&](const Vec3&) { return t == missing ? kInfinity : 1.0 + t; }));
    for (const std::uint32_t texel : surface.sample_texels()) {
      if (texel >= maps.least().size()) continue;  // of a face without a texel
      ASSERT_EQ(maps.least()[texel], missing == 0 ? 2 : 1);
      ASSERT_EQ(maps.largest()[texel], kInfinity);
      ASSERT_EQ(maps.mean()[texel], kInfinity);
    }
  }
}

TEST(Temporal, ContinuesFromAState) {
  const Surface surface(ring(12), {.resolution = 64});
  TemporalMaps all, some;
  for (int t = 0; t < 9; ++t) {
    if (t == 0 || t == 4) some = TemporalMaps(some.state());
    const DistanceMap map = map_of(surface, [&](const Vec3& p) { return p[0] + std::cos(t * p[1]) / 3; });
    all.add(map);
    some.add(map);
  }
  EXPECT_EQ(some.maps(), 9u);
  for (const std::uint32_t texel : surface.sample_texels()) {
    if (texel >= some.least().size()) continue;
    ASSERT_EQ(some.least()[texel], all.least()[texel]);
    ASSERT_EQ(some.largest()[texel], all.largest()[texel]);
    ASSERT_EQ(some.state().sum[texel], all.state().sum[texel]);
  }
  TemporalMaps::State damaged = all.state();
  damaged.largest.pop_back();
  EXPECT_THROW(TemporalMaps{damaged}, Error);
}

TEST(Temporal, RejectsMapsOfOtherSizes) {
  TemporalMaps maps;
  maps.add(map_of(Surface(ring(12), {.resolution = 64}), [](const Vec3&) { return 1; }));
  EXPECT_THROW(maps.add(map_of(Surface(ring(12), {.resolution = 32}), [](const Vec3&) { return 1; })), Error);
  EXPECT_EQ(maps.maps(), 1u);
}

}  // namespace
}  // namespace sdm::test

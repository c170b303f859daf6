// Const queries from many threads on the same surface and sites. ThreadSanitizer runs these, too.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include "support/meshes.h"
#include "support/owned_texels.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

TEST(Threads, ShareASurfaceAndSites) {
  const Mesh on = load("cow.off", "fit"), to = moved(load("knot1.off", "fit"), {0.1, 0.1, 0});
  const Surface surface(on, {.resolution = 128});
  const Sites sites(to);
  struct Result {
    std::vector<float> distance, occlusion;
    std::vector<std::uint8_t> inside;
    std::vector<std::uint32_t> hits;
    double bound = 0;
    bool operator==(const Result&) const = default;
  };
  const auto all = [&] {
    Result result;
    const DistanceMap map = compute_map(surface, sites);
    for (const std::uint32_t texel : test::owned_texels(surface))
      result.distance.push_back(map.distance[texel]);
    const std::vector<ClosestPoint> closest = closest_points(sites, on.positions);
    result.inside = inside_flags(sites, on.positions, closest, SignMethod::winding);
    std::vector<Ray> rays;
    for (const Vec3& p : on.positions) rays.push_back({.origin = p, .direction = {1, 0.1, 0.2}});
    for (const RayHit& hit : first_hits(sites, rays)) result.hits.push_back(hit.face);
    const std::vector<float> occlusion = ambient_occlusion(surface, sites, map, {.rays = 4});
    for (const std::uint32_t texel : test::owned_texels(surface))
      result.occlusion.push_back(occlusion[texel]);
    result.bound = SamplingBound(surface).value();
    return result;
  };
  std::array<Result, 4> found;
  {
    std::vector<std::jthread> threads;
    for (Result& result : found) threads.emplace_back([&] { result = all(); });
  }
  const Result alone = all();
  EXPECT_GT(alone.bound, 0);
  EXPECT_TRUE(std::ranges::count(alone.inside, 1) > 0 && std::ranges::count(alone.hits, kNone) > 0);
  for (const Result& result : found) EXPECT_TRUE(result == alone);
}

TEST(Threads, ShareTheMapsOfABodyToOthers) {
  MultiBodyQuery bodies(with_atlases(std::vector{sphere(2), moved(sphere(2), {2.2, 0, 0}), cube()}, 64));
  std::array<NearestMap, 6> found;
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < found.size(); ++i)
      threads.emplace_back([&, i] { found[i] = bodies.nearest_map(i % 3); });
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    const NearestMap alone = bodies.nearest_map(i % 3);
    EXPECT_EQ(found[i].body, alone.body);
    for (const std::uint32_t texel : bodies.surface(i % 3).sample_texels())
      ASSERT_EQ(found[i].map.distance[texel], alone.map.distance[texel]);
  }
}

}  // namespace
}  // namespace sdm::test

// Maps computed in parts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <variant>
#include <vector>

#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using testing::HasSubstr;

std::vector<std::uint32_t> bits(const DistanceMap& map) {
  std::vector<std::uint32_t> all;
  for (const float d : map.distance) all.push_back(std::bit_cast<std::uint32_t>(d));
  for (const Vec3f& v : map.vector)
    for (const float x : v) all.push_back(std::bit_cast<std::uint32_t>(x));
  all.insert(all.end(), map.site.begin(), map.site.end());
  for (const SiteType type : map.site_type) all.push_back(static_cast<std::uint32_t>(type));
  all.insert(all.end(), map.unmatched.begin(), map.unmatched.end());
  return all;
}

std::vector<SampleRange> ranges_of(const Surface& surface, std::size_t blocks) {
  const std::size_t samples = surface.sample_texels().size(), size = blocks * sample_range_grain(surface);
  std::vector<SampleRange> ranges;
  for (std::size_t first = 0; first < samples; first += size)
    ranges.push_back({first, std::min(size, samples - first)});
  return ranges;
}

TEST(MapSamples, InAnyOrderAreTheMapToTheBit) {
  std::mt19937 random(5);
  const Mesh on = load("cow.off", "fit"), cube_in_cube = moved(cube(), {0.25, 0.25, 0.25});
  const std::vector<std::pair<Mesh, Mesh>> pairs{
      {on, moved(load("knot1.off", "fit"), {0.1, 0.1, 0})}, {cube(), cube_in_cube}, {on, height_field(9)}};
  for (const auto& [o1, o2] : pairs)
    for (const double max_distance : {std::numeric_limits<double>::infinity(), 0.2}) {
      const Surface surface(o1, {.resolution = 200});
      const Sites sites(o2);
      const MapOptions options{.max_distance = max_distance};
      const DistanceMap whole = compute_map(surface, sites, options);
      DistanceMap parts = empty_map(surface);
      EXPECT_TRUE(std::ranges::all_of(parts.distance, [](float d) { return std::isnan(d); }));
      EXPECT_EQ(std::ranges::count(parts.site, kNone), std::ssize(parts.site));
      std::vector<SampleRange> ranges = ranges_of(surface, 3);
      ASSERT_GT(ranges.size(), 5u);
      std::ranges::shuffle(ranges, random);
      std::size_t beyond = 0;
      for (const SampleRange& range : ranges) {
        compute_samples(surface, sites, options, range, parts);
        beyond += parts.beyond_max_distance;
      }
      EXPECT_TRUE(bits(parts) == bits(whole));
      EXPECT_EQ(beyond, whole.beyond_max_distance);
      EXPECT_EQ(parts.sign.method, whole.sign.method);
      EXPECT_EQ(parts.sign.reason, whole.sign.reason);
    }
}

TEST(MapSamples, OfFacingFacesAreTheMapToTheBit) {
  const Surface surface(moved(sphere(4), {0, 0, 1}), {.resolution = 128});
  for (const auto& [o2, unmatched] : {std::pair{cube(), false}, {height_field(9), true}}) {
    const Sites sites(o2);
    const MapOptions options{.max_distance = 0.5, .facing = 60};
    const DistanceMap whole = compute_map(surface, sites, options);
    EXPECT_EQ(whole.without_match > 0, unmatched);
    EXPECT_GT(whole.beyond_max_distance, 0u);
    DistanceMap parts = compute_map(surface, Sites(height_field(9)), options);  // of which nothing may stay
    std::size_t without_match = 0;
    std::vector<SampleRange> ranges = ranges_of(surface, 2);
    std::ranges::reverse(ranges);
    for (const SampleRange& range : ranges) {
      compute_samples(surface, sites, options, range, parts);
      without_match += parts.without_match;
    }
    EXPECT_TRUE(bits(parts) == bits(whole));
    EXPECT_EQ(without_match, whole.without_match);
    count_missing(surface, parts);
    EXPECT_EQ(parts.without_match, whole.without_match);
    EXPECT_EQ(parts.beyond_max_distance, whole.beyond_max_distance);
    EXPECT_EQ(parts.measured.facing, 60);
    EXPECT_EQ(parts.sign.method, SignMethod::side);
  }
}

TEST(MapSamples, OfOtherMeasuresAreTheMapToTheBit) {
  const Surface surface(sphere(4), {.resolution = 128});
  const Sites itself(surface.mesh()), beside(moved(cube(), {0, 0, 1}));
  const Exclusion exclusion(surface.mesh(), {.rule = {.geodesic = 0.5}});
  for (const Measure& measure :
       {Measure(AlongOptions{.max_distance = 0.5}), Measure(SelfOptions{exclusion, 1.0}),
        Measure(ThicknessOptions{.angle = 45}), Measure(MapOptions{.max_distance = 0.2})}) {
    const bool by_itself =
        std::holds_alternative<SelfOptions>(measure) || std::holds_alternative<ThicknessOptions>(measure);
    const Sites& sites = by_itself ? itself : beside;
    const DistanceMap whole = compute_map(surface, sites, measure);
    DistanceMap parts = empty_map(surface);
    std::vector<SampleRange> ranges = ranges_of(surface, 3);
    ASSERT_GT(ranges.size(), 5u);
    std::ranges::reverse(ranges);
    std::size_t beyond = 0, without_match = 0;
    for (const SampleRange& range : ranges) {
      compute_samples_of_measure(surface, sites, measure, range, parts);
      beyond += parts.beyond_max_distance;
      without_match += parts.without_match;
    }
    EXPECT_TRUE(bits(parts) == bits(whole)) << measure.index();
    EXPECT_EQ(beyond, whole.beyond_max_distance);
    EXPECT_EQ(without_match, whole.without_match);
    count_missing(surface, parts);
    EXPECT_EQ(parts.without_match, whole.without_match);
    EXPECT_EQ(parts.beyond_max_distance, whole.beyond_max_distance);
    EXPECT_EQ(parts.measured.kind, whole.measured.kind);
    EXPECT_THROW(compute_samples_of_measure(surface, sites, measure, {1, 1}, parts), Error);
  }
}

TEST(MapSamples, LeaveTheOtherTexelsAsTheyAre) {
  const Surface surface(sphere(3), {.resolution = 128});
  DistanceMap map = empty_map(surface);
  const std::size_t grain = sample_range_grain(surface);
  compute_samples(surface, Sites(cube()), {}, {grain, 2 * grain}, map);
  for (std::size_t i = 0; i < surface.sample_texels().size(); ++i)
    EXPECT_EQ(std::isnan(map.distance[surface.sample_texels()[i]]), i < grain || i >= 3 * grain) << i;
}

TEST(MapSamples, RefuseWhatTheyCannotDo) {
  const Surface surface(sphere(3), {.resolution = 128}), other(sphere(3), {.resolution = 64});
  const Sites sites(cube());
  DistanceMap map = empty_map(surface), of_other = empty_map(other);
  const std::size_t grain = sample_range_grain(surface), samples = surface.sample_texels().size();
  const auto fault = [&](const MapOptions& options, const SampleRange& range, DistanceMap& into) {
    try {
      compute_samples(surface, sites, options, range, into);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(fault({}, {0, grain + 1}, map), HasSubstr("must begin and end at multiples of"));
  EXPECT_THAT(fault({}, {1, samples - 1}, map), HasSubstr("must begin and end at multiples of"));
  EXPECT_THAT(fault({}, {0, samples + grain}, map), HasSubstr("must begin and end at multiples of"));
  EXPECT_THAT(fault({}, {SIZE_MAX - grain + 1, grain}, map), HasSubstr("must begin and end at multiples of"));
  EXPECT_THAT(fault({}, {0, grain}, of_other), HasSubstr("belongs to another surface"));
  EXPECT_EQ(fault({}, {0, samples}, map), "");
  EXPECT_THROW(count_missing(surface, of_other), Error);
}

}  // namespace
}  // namespace sdm::test

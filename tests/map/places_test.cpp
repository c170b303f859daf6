// The places where a map deviates most.
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/places.h>
#include <sdm/statistics.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/made_up_maps.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

struct Cap {
  Vec3 centre;
  double angle, value;
};

/// 0 but for caps of the unit sphere.
Field caps_field(const std::vector<Cap>& caps) {
  return [=](const Vec3& p) {
    for (const Cap& cap : caps)
      if (dot(normalized(p), normalized(cap.centre)) > std::cos(cap.angle)) return cap.value;
    return 0.0;
  };
}

/// Two caps at corners of an octahedron and one between, where charts meet.
const std::vector<Cap> kCaps{{{0, 0, 1}, 0.3, 2}, {{1, 1, 1}, 0.2, -3}, {{-1, 0, 0.2}, 0.25, 1}};

double area_of(const Cap& cap) {
  return 2 * std::numbers::pi * (1 - std::cos(cap.angle));
}

TEST(Places, AreRegionsAcrossTheChartsOfAnyAtlas) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
    const Surface surface(sphere(4), {.kind = kind, .resolution = 512});
    ASSERT_GT(surface.chart_count(), 1u);
    const Field field = caps_field(kCaps);
    const Places places = find_places(surface, map_of(surface, field), at_vertices(surface.mesh(), field),
                                      {.tolerance = Tolerance(0.5), .accuracy = 1e-6});
    EXPECT_TRUE(places.by_tolerance);
    EXPECT_EQ(places.limits, Tolerance(0.5));
    EXPECT_EQ(places.large.count, 3u);
    EXPECT_EQ(places.small.count, 0u);
    ASSERT_EQ(places.largest.size(), 3u);
    const std::vector<std::size_t> order{1, 0, 2};
    double fractions = 0, area = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Cap& cap = kCaps[order[i]];
      const Place& place = places.largest[i];
      EXPECT_EQ(place.distance, cap.value);
      EXPECT_NEAR(place.area, area_of(cap), 0.06 * area_of(cap));
      EXPECT_NEAR(place.fraction, area_of(cap) / (4 * std::numbers::pi), 0.001);
      EXPECT_GT(dot(normalized(place.point), normalized(cap.centre)), std::cos(cap.angle) - 0.02);
      fractions += place.fraction;
      area += place.area;
    }
    EXPECT_NEAR(places.large.fraction, fractions, 1e-12);
    EXPECT_NEAR(places.large.area, area, 1e-12);
  }
}

TEST(Places, BeyondOppositeLimitsAreSeparate) {
  const Surface surface(sphere(4), {.resolution = 256});
  const Field field = [](const Vec3& p) { return std::abs(p[2]) < 0.3 ? (p[0] > 0 ? 1.0 : -1.0) : 0.0; };
  const Places places = find_places(surface, map_of(surface, field), at_vertices(surface.mesh(), field),
                                    {.tolerance = Tolerance(0.5)});
  EXPECT_EQ(places.large.count, 2u);
  // Above the upper limit only.
  EXPECT_EQ(find_places(surface, map_of(surface, field), at_vertices(surface.mesh(), field),
                        {.tolerance = Tolerance(-2, 0.5)})
                .large.count,
            1u);
}

// What single points have is no place of the list before regions, whatever its distance.
TEST(Places, SingleVerticesAreSmallAndCounted) {
  const Surface surface(sphere(5), {.resolution = 512});
  const Field field = caps_field(kCaps);
  std::vector<float> vertices = at_vertices(surface.mesh(), field);
  std::size_t spikes = 0;
  for (std::size_t v = 0; v < vertices.size(); v += 97)
    if (std::ranges::all_of(kCaps, [&](const Cap& cap) {
          return dot(normalized(surface.mesh().positions[v]), normalized(cap.centre)) <
                 std::cos(cap.angle + 0.1);
        })) {
      vertices[v] = 50;
      ++spikes;
    }
  ASSERT_GT(spikes, 20u);
  const Places places = find_places(surface, map_of(surface, field), vertices, {.tolerance = Tolerance(0.5)});
  EXPECT_EQ(places.large.count, 3u);
  EXPECT_EQ(places.small.count, spikes);
  EXPECT_EQ(places.small.area, 0);
  ASSERT_EQ(places.largest.size(), Places::kListed);
  for (std::size_t i = 0; i < places.largest.size(); ++i) {
    EXPECT_EQ(places.largest[i].small, i >= 3);
    EXPECT_EQ(places.largest[i].distance == 50, i >= 3);
    EXPECT_EQ(places.largest[i].sample == kNone, i >= 3);
  }
}

TEST(Places, AreBeyondThePercentileWhereNothingIsOutOfTolerance) {
  const Surface surface(sphere(4), {.resolution = 256});
  const Field field = [](const Vec3& p) { return p[2] > 0 ? p[2] : 0.1 * p[2]; };
  const DistanceMap map = map_of(surface, field);
  const double p99 = statistics(surface, map).p99_abs;
  for (const std::optional<Tolerance>& tolerance :
       {std::optional<Tolerance>(), std::optional(Tolerance(2))}) {
    const Places places = find_places(surface, map, at_vertices(surface.mesh(), field),
                                      {.tolerance = tolerance, .accuracy = 1e-6, .p99_abs = p99});
    EXPECT_FALSE(places.by_tolerance);
    EXPECT_EQ(places.limits, Tolerance(p99));
    ASSERT_EQ(places.large.count, 1u);
    EXPECT_NEAR(places.large.fraction, 0.01, 0.002);
    EXPECT_EQ(places.largest[0].distance, 1);
  }
  const Field nothing = [](const Vec3&) { return 1e-7; };
  EXPECT_EQ(
      find_places(surface, map_of(surface, nothing), {}, {.accuracy = 1e-6, .p99_abs = 1e-7}).large.count,
      0u);
  const Field none = [](const Vec3&) { return std::nan(""); };
  EXPECT_TRUE(
      find_places(surface, map_of(surface, none), at_vertices(surface.mesh(), none), {}).largest.empty());
}

TEST(Places, HaveTheGroupOfTheirLargestSample) {
  const Surface surface(sphere(3), {.resolution = 256});
  FaceNames names{"group", {"north", "south"}, {}};
  for (const Triangle& t : surface.mesh().triangles)
    names.of_face.push_back(surface.mesh().positions[t[0]][2] > 0 ? 0 : 1);
  const Field field = caps_field(kCaps);
  const Places places =
      find_places(surface, map_of(surface, field), {}, {.tolerance = Tolerance(0.5), .names = {&names, 1}});
  ASSERT_EQ(places.largest.size(), 3u);
  for (const Place& place : places.largest) EXPECT_EQ(place.group, names.names[names.of_face[place.face]]);
  EXPECT_EQ(places.largest[1].group, "north");
  EXPECT_EQ(places.largest[1].kind, "group");
}

// The lower half of the sphere may deviate by 4, the upper one by what is accepted of all.
TEST(Places, AreOutOfTheLimitsOfTheirGroups) {
  const Surface surface(sphere(3), {.resolution = 256});
  FaceNames names{"group", {"north", "south"}, {}};
  for (const Triangle& t : surface.mesh().triangles) {
    double z = 0;
    for (const std::uint32_t v : t) z += surface.mesh().positions[v][2];
    names.of_face.push_back(z > 0 ? 0 : 1);
  }
  const Field field = caps_field({{{0, 0, 1}, 0.3, 2}, {{0, 0, -1}, 0.3, 3}, {{0, 1, -1}, 0.1, 5}});
  const auto find = [&](std::optional<Tolerance> of_all, const std::vector<GroupTolerance>& table) {
    return find_places(surface, map_of(surface, field), at_vertices(surface.mesh(), field),
                       {.tolerance = of_all, .table = table, .p99_abs = 3, .names = {&names, 1}});
  };
  const Places of_south = find({}, {{"south", Tolerance(4)}});
  ASSERT_EQ(of_south.large.count, 1u);
  EXPECT_TRUE(of_south.by_tolerance);
  EXPECT_EQ(of_south.largest[0].distance, 5);
  EXPECT_EQ(of_south.largest[0].limits, Tolerance(4));
  const Places both = find({}, {{"south", Tolerance(4)}, {"north", Tolerance(-1, 0.5)}});
  ASSERT_EQ(both.large.count, 2u);
  EXPECT_EQ(both.largest[0].group, "north") << "2 is farther beyond 0.5 than 5 beyond 4";
  EXPECT_EQ(both.largest[0].limits, Tolerance(-1, 0.5));
  const Places and_all = find(Tolerance(2.5), {{"south", Tolerance(4)}});
  ASSERT_EQ(and_all.large.count, 2u) << "that of all judges the faces of groups too";
  EXPECT_EQ(and_all.limits, Tolerance(2.5));
  EXPECT_EQ(and_all.largest[1].distance, 3);
  const Places none = find({}, {{"south", Tolerance(6)}});
  EXPECT_FALSE(none.by_tolerance);
  EXPECT_EQ(none.limits, Tolerance(3));
}

// A region across a border of groups, which is a seam of the atlas in places, is one place for each group
// that refuses it, and one place where the same rows judge both sides.
TEST(Places, EndAtTheBordersOfGroups) {
  const Field field = caps_field({{{1, 0, 0}, 0.4, 2}});
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
    const Surface surface(sphere(3), {.kind = kind, .resolution = 256});
    FaceNames names{"group", {"north", "south"}, {}};
    for (const Triangle& t : surface.mesh().triangles) {
      double z = 0;
      for (const std::uint32_t v : t) z += surface.mesh().positions[v][2];
      names.of_face.push_back(z > 0 ? 0 : 1);
    }
    const auto find = [&](std::optional<Tolerance> of_all, const std::vector<GroupTolerance>& table) {
      return find_places(surface, map_of(surface, field), at_vertices(surface.mesh(), field),
                         {.tolerance = of_all, .table = table, .p99_abs = 3, .names = {&names, 1}});
    };
    const Places both = find({}, {{"south", Tolerance(0.5)}, {"north", Tolerance(1)}});
    ASSERT_EQ(both.large.count, 2u);
    EXPECT_EQ(both.largest[0].group, "south");
    EXPECT_EQ(both.largest[0].limits, Tolerance(0.5));
    EXPECT_LT(both.largest[0].point[2], 0.1);
    EXPECT_EQ(both.largest[1].group, "north");
    EXPECT_EQ(both.largest[1].limits, Tolerance(1));
    for (const Place& place : both.largest) EXPECT_GT(place.area, 0.2);
    EXPECT_NEAR(both.largest[0].area + both.largest[1].area, area_of({{}, 0.4, 0}), 0.02);
    const Places one = find({}, {{"south", Tolerance(0.5)}, {"north", Tolerance(3)}});
    EXPECT_EQ(one.large.count, 1u);
    EXPECT_EQ(find(Tolerance(0.5), {}).large.count, 1u);
  }
}

TEST(Places, OfSamplesWithoutAValueAreListedAfterTheOthers) {
  const Surface surface(sphere(3), {.resolution = 256});
  const double nan = std::nan("");
  const Field field = caps_field({{{0, 0, 1}, 0.3, nan}, {{0, 0, -1}, 0.2, nan}, {{1, 0, 0}, 0.1, 3}});
  const auto find = [&](std::optional<Tolerance> tolerance) {
    return find_places(surface, map_of(surface, field), at_vertices(surface.mesh(), field),
                       {.tolerance = tolerance, .p99_abs = 2});
  };
  const Places places = find(Tolerance(1));
  ASSERT_EQ(places.large.count, 3u);
  EXPECT_EQ(places.largest[0].distance, 3);
  EXPECT_TRUE(std::isnan(places.largest[1].distance));
  EXPECT_TRUE(std::isnan(places.largest[2].distance));
  EXPECT_GT(places.largest[1].area, places.largest[2].area);
  EXPECT_NEAR(places.largest[1].area, area_of({{0, 0, 1}, 0.3, 0}), 0.1);
  EXPECT_GT(places.largest[1].point[2], 0.9);
  EXPECT_TRUE(find(Tolerance(9)).by_tolerance) << "nothing else is out";
  EXPECT_FALSE(find({}).by_tolerance) << "nothing asks for values";
  EXPECT_EQ(find({}).large.count, 1u);
}

TEST(Places, OfPartsAreAddedUp) {
  const Surface surface(sphere(4), {.resolution = 256});
  const Field field = caps_field(kCaps), flat = caps_field({});
  const Places some = find_places(surface, map_of(surface, field), {}, {.tolerance = Tolerance(0.5)});
  const Places none = find_places(surface, map_of(surface, flat), {}, {.tolerance = Tolerance(0.5)});
  const auto all = combined_places(std::vector{some, none, some}, std::vector{1.0, 2.0, 1.0});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->large.count, 6u);
  EXPECT_NEAR(all->large.fraction, some.large.fraction / 2, 1e-12);
  ASSERT_EQ(all->largest.size(), 6u);
  EXPECT_EQ(all->largest[0].distance, -3);
  EXPECT_EQ(all->largest[1].distance, -3);
  EXPECT_FALSE(combined_places(std::vector{none}, std::vector{1.0}));
}

TEST(Places, AreOfTheSurfaceOfTheMap) {
  const Surface surface(sphere(2), {.resolution = 64}), other(sphere(2), {.resolution = 128});
  const Field field = caps_field(kCaps);
  EXPECT_THROW((void)find_places(other, map_of(surface, field), {}, {}), Error);
  EXPECT_THROW((void)find_places(surface, map_of(surface, field), std::vector<float>(3), {}), Error);
}

}  // namespace
}  // namespace sdm::test

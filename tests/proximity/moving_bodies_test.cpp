// The first contacts of worlds that move, against those of every pair and against known times.
#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using BodyNumbers = std::pair<std::uint32_t, std::uint32_t>;

Transform turned_pose(std::mt19937& random, const Vec3& at) {
  std::normal_distribution<double> normal;
  return Transform::translation(at) *
         Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
}

// A world of different shapes, of which a third rests.
struct MovingWorld {
  std::vector<Shape> shapes;
  std::vector<Motion> motions;

  MovingWorld(std::size_t bodies, double size, double step, unsigned seed) {
    const std::vector<Shape> kinds{Shape(sphere(2)), Shape(torus(16, 12)), Shape(cube(0.7)),
                                   Shape(square(2, 0)), Shape(wedge(0.1))};
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, size), shift(-step, step);
    for (std::size_t b = 0; b < bodies; ++b) {
      shapes.push_back(kinds[b % kinds.size()]);
      const Vec3 at{place(random), place(random), place(random)};
      const Transform from = turned_pose(random, at);
      Transform to = turned_pose(random, at + Vec3{shift(random), shift(random), shift(random)});
      if (b % 3 == 0) to = from;
      motions.push_back({from, to});
    }
  }
};

void expect_same(const TimeOfContact& found, const TimeOfContact& expected) {
  EXPECT_TRUE(found.contact);
  EXPECT_EQ(found.time, expected.time);
  EXPECT_EQ(found.separation, expected.separation);
  EXPECT_EQ(found.certainty, expected.certainty);
  EXPECT_EQ(found.witness, expected.witness);
  EXPECT_EQ(found.faces, expected.faces);
  EXPECT_EQ(found.normal, expected.normal);
}

bool in_order(const PairTimeOfContact& a, const PairTimeOfContact& b) {
  const auto order = [](const PairTimeOfContact& c) {
    return std::tuple(c.time_of_contact.time, c.first, c.second);
  };
  return order(a) < order(b);
}

// Every pair by itself, whatever its boxes, and filters as MultiBodyQuery documents them.
TEST(MovingBodies, AreThoseOfEveryPair) {
  constexpr double kTolerance = 1e-4;
  for (const unsigned seed : {1u, 2u}) {
    const MovingWorld world(40, 14, 4, seed);
    MultiBodyQuery query(world.shapes);
    query.set_filter(3, {.fixed = true});
    query.set_filter(4, {.fixed = true});
    for (std::size_t b = 5; b < 10; ++b) query.set_filter(b, {.groups = 2});
    for (std::size_t b = 10; b < 15; ++b) query.set_filter(b, {.mask = 1});
    query.exclude_pair(20, 19);
    const std::vector<PairTimeOfContact> found = query.time_of_contact(world.motions, kTolerance);
    EXPECT_TRUE(std::ranges::is_sorted(found, in_order));
    std::map<BodyNumbers, TimeOfContact> by_pair;
    for (const PairTimeOfContact& pair : found) by_pair[{pair.first, pair.second}] = pair.time_of_contact;
    EXPECT_EQ(by_pair.size(), found.size());
    std::size_t contacts = 0, at_first = 0;
    for (std::uint32_t a = 0; a < world.shapes.size(); ++a)
      for (std::uint32_t b = a + 1; b < world.shapes.size(); ++b) {
        const BodyFilter first = query.filter(a), second = query.filter(b);
        const bool meets = !(first.fixed && second.fixed) && (first.groups & second.mask) != 0 &&
                           (second.groups & first.mask) != 0 && !(a == 19 && b == 20);
        const TimeOfContact single =
            time_of_contact(world.shapes[a], world.motions[a], world.shapes[b], world.motions[b], kTolerance);
        ASSERT_EQ(by_pair.contains({a, b}), meets && single.contact) << a << " " << b;
        if (!meets || !single.contact) continue;
        expect_same(by_pair[{a, b}], single);
        ++contacts;
        at_first += single.time == 0;
      }
    EXPECT_GT(contacts, 20u);
    EXPECT_GT(at_first, 0u);
    EXPECT_LT(at_first, contacts);
  }
}

TEST(MovingBodies, UntilATimeOrTheEarliest) {
  const MovingWorld world(60, 24, 5, 7);
  const MultiBodyQuery query(world.shapes);
  std::vector<PairTimeOfContact> all = query.time_of_contact(world.motions, 1e-4);
  std::erase_if(all, [](const PairTimeOfContact& pair) { return pair.time_of_contact.time > 0.4; });
  const auto pairs = [](const std::vector<PairTimeOfContact>& contacts) {
    std::vector<std::tuple<std::uint32_t, std::uint32_t, double>> result;
    for (const auto& [a, b, found, parts] : contacts) result.emplace_back(a, b, found.time);
    return result;
  };
  EXPECT_GT(all.size(), 1u);
  EXPECT_EQ(pairs(query.time_of_contact(world.motions, 1e-4, {.until = 0.4})), pairs(all));
  const double earliest = all.front().time_of_contact.time;
  std::erase_if(all, [&](const PairTimeOfContact& pair) { return pair.time_of_contact.time > earliest; });
  for (const unsigned threads : {1u, 4u}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(pairs(query.time_of_contact(world.motions, 1e-4, {.earliest_only = true})), pairs(all));
  }
}

// Both ends of the motion are free, and there are bodies in between on the way of the bullet alone.
TEST(MovingBodies, NoneIsMissedByABullet) {
  Mesh plate = cube();
  for (Vec3& p : plate.positions) p[0] *= 1e-4;
  constexpr std::size_t kPlates = 20;
  std::vector<Shape> shapes(kPlates, Shape(plate));
  shapes.emplace_back(placed(sphere(3), "scale:0.1"));
  std::vector<Motion> motions(shapes.size());
  for (std::size_t i = 0; i < kPlates; ++i) {
    const Transform at = Transform::translation({static_cast<double>(i), i % 2 == 0 ? 0.0 : 5.0, 0});
    motions[i] = {at, at};
  }
  motions.back() = {Transform::translation({-500, 0, 0}), Transform::translation({500, 0, 0})};
  const MultiBodyQuery query(shapes);
  const std::vector<PairTimeOfContact> found = query.time_of_contact(motions, 1e-5);
  ASSERT_EQ(found.size(), kPlates / 2);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].first, 2 * i);  // every other one
    EXPECT_EQ(found[i].second, kPlates);
    const double x = 2 * static_cast<double>(i) - 1e-4 - 0.1;
    EXPECT_NEAR(found[i].time_of_contact.time, (500 + x) / 1000, 1e-7);
    EXPECT_NEAR(found[i].time_of_contact.normal.value()[0], 1, 1e-3);  // O1 is the plate
    EXPECT_NEAR(found[i].time_of_contact.witness[0][0], x + 0.1, 1e-4);
  }
}

// A ball that falls to a plane, and a bar that turns to the edge of a wall.
TEST(MovingBodies, AtKnownTimes) {
  const double turn = 0.75 * std::acos(-1.0);
  Mesh bar = cube();
  for (Vec3& p : bar.positions) p = {3 * p[0], 0.01 * p[1], 0.01 * p[2]};
  const std::vector<Shape> shapes{Shape(sphere(4)), Shape(square(8, 0)), Shape(bar), Shape(cube())};
  const auto at = [](const Vec3& place) { return Transform::translation(place); };
  const std::vector<Motion> motions{{at({0, 0, 6}), at({1, 0, -4})},
                                    {},
                                    {at({0, 0, 20}), at({0, 0, 20}) * Transform::rotation({0, 0, 135})},
                                    {at({0, 3, 20}), at({0, 3, 20})}};
  const std::vector<PairTimeOfContact> found = MultiBodyQuery(shapes).time_of_contact(motions, 1e-9);
  ASSERT_EQ(found.size(), 2u);
  // The bar is longer than its way to the corner (1, 2) of the wall, which meets its side.
  const double angle = std::atan2(2.0, 1.0) - std::asin(0.01 / std::hypot(1.0, 2.0));
  EXPECT_EQ(found[0].first, 2u);
  EXPECT_EQ(found[0].second, 3u);
  EXPECT_NEAR(found[0].time_of_contact.time, angle / turn, 1e-8);
  EXPECT_EQ(found[1].first, 0u);
  EXPECT_NEAR(found[1].time_of_contact.time, 0.5, 1e-3);  // the ball is a polyhedron
  EXPECT_NEAR(found[1].time_of_contact.normal.value()[2], 1, 1e-6);
}

TEST(MovingBodies, ManyAtOnce) {
  constexpr std::size_t kBodies = 1000;
  const MovingWorld world(kBodies, 38, 1, 3);
  const MultiBodyQuery query(world.shapes);
  const std::vector<PairTimeOfContact> found = query.time_of_contact(world.motions, 1e-3);
  EXPECT_GT(found.size(), 500u);
  EXPECT_TRUE(std::ranges::is_sorted(found, in_order));
  // Spheres of bounding radii tell most pairs apart; of the others, a sample is found by itself.
  std::map<BodyNumbers, double> times;
  for (const PairTimeOfContact& pair : found) times[{pair.first, pair.second}] = pair.time_of_contact.time;
  std::size_t asked = 0, compared = 0;
  for (std::uint32_t a = 0; a < kBodies; ++a)
    for (std::uint32_t b = a + 1; b < kBodies; ++b) {
      const Vec3 at_a = world.motions[a].from({}), at_b = world.motions[b].from({});
      if (norm(at_a - at_b) > 9.5) continue;  // at most 3 + 3 of the bodies and 2√3 of the motions
      if (asked++ % 97 != 0) continue;
      const TimeOfContact single =
          time_of_contact(world.shapes[a], world.motions[a], world.shapes[b], world.motions[b], 1e-3);
      const auto known = times.find({a, b});
      ASSERT_EQ(known != times.end(), single.contact) << a << " " << b;
      if (single.contact) {
        EXPECT_EQ(known->second, single.time);
      }
      ++compared;
    }
  EXPECT_GT(compared, 100u);
}

TEST(MovingBodies, RejectBadInput) {
  const std::vector<Shape> shapes{Shape(cube()), Shape(cube())};
  const MultiBodyQuery query(shapes);
  std::vector<Motion> motions(2);
  EXPECT_THROW((void)query.time_of_contact(std::span(motions).first(1), 1e-3), Error);
  for (const double tolerance : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW((void)query.time_of_contact(motions, tolerance), Error);
  for (const double until : {-0.1, 1.1, std::nan("")})
    EXPECT_THROW((void)query.time_of_contact(motions, 1e-3, {.until = until}), Error);
  motions[1].to = Transform::scaling(2);
  try {
    (void)query.time_of_contact(motions, 1e-3);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("body 1"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(MultiBodyQuery(std::vector<Shape>{}).time_of_contact({}, 1e-3).empty());
}

}  // namespace
}  // namespace sdm::test

// Bodies of several shapes, against single calls for all pairs of their parts.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "mesh/similarity.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr double kCompoundMargin = 0.05;

using Compounds = std::vector<std::vector<BodyPart>>;

class RandomPoses {
 public:
  explicit RandomPoses(unsigned seed) : random_(seed) {}

  Transform pose(double reach, double scale = 1) {
    std::uniform_real_distribution<double> place(-reach, reach);
    std::normal_distribution<double> normal;
    return Transform::translation({place(random_), place(random_), place(random_)}) *
           Transform::quaternion({normal(random_), normal(random_), normal(random_), normal(random_)}) *
           Transform::scaling(scale);
  }

 private:
  std::mt19937 random_;
};

// Three compounds, one of them of a single part that is turned, and two plain bodies; solids and surfaces.
Compounds compounds(RandomPoses& random) {
  const Shape ball(sphere(1)), box(cube(0.6)), tetra(tetrahedron());
  Mesh sheet = cube(0.8);
  sheet.triangles.resize(4);
  const Shape open(sheet);
  Compounds bodies(5);
  for (const Shape& shape : {ball, box, tetra}) bodies[0].push_back({shape, random.pose(0.8, 0.5)});
  for (const Shape& shape : {box, box}) bodies[1].push_back({shape, random.pose(0.6)});
  bodies[2] = {{box}};
  bodies[3] = {{tetra, random.pose(0.3)}};
  bodies[4] = {{open}, {ball, random.pose(1, 0.4)}};
  return bodies;
}

/// The answers for a pair of bodies, from single calls for its parts.
struct Expected {
  BoundedLength separation{{.value = std::numeric_limits<double>::infinity()}, {}};
  PartPair nearest{};
  bool colliding = false;
  std::optional<BoundedLength> depth;
  PartPair deepest{};
  std::map<PartPair, std::vector<Contact>> contacts;
};

// `poses`: of the bodies, as they were given.
Expected expected_of(const std::vector<Transform>& poses, const Compounds& bodies, std::size_t a,
                     std::size_t b) {
  const auto pose_of = [&](std::size_t body, std::size_t part) {
    if (body == 2) return poses[body];  // a plain body
    return mesh::Similarity::of(poses[body]).transform() *
           mesh::Similarity::of(bodies[body][part].pose).transform();
  };
  Expected expected;
  for (std::uint32_t i = 0; i < bodies[a].size(); ++i)
    for (std::uint32_t j = 0; j < bodies[b].size(); ++j) {
      ProximityQuery pair(bodies[a][i].shape, bodies[b][j].shape, {.contact_margin = kCompoundMargin});
      pair.set_pose(0, pose_of(a, i));
      pair.set_pose(1, pose_of(b, j));
      if (pair.separation().value < expected.separation.value) {
        expected.separation = pair.separation();
        expected.nearest = {i, j};
      }
      if (const std::span<const Contact> contacts = pair.contacts(); !contacts.empty())
        expected.contacts[{i, j}].assign(contacts.begin(), contacts.end());
      if (!pair.colliding()) continue;
      expected.colliding = true;
      const std::optional<BoundedLength>& depth = pair.penetration_depth();
      if (!depth) continue;
      BoundedLength most = expected.depth.value_or(*depth);
      const double lower = std::max(most.lower, depth->lower), upper = std::max(most.upper, depth->upper);
      if (!expected.depth || depth->value > most.value) {
        most = *depth;
        expected.deepest = {i, j};
      }
      most.lower = lower;
      most.upper = upper;
      expected.depth = most;
    }
  return expected;
}

void expect_same_length(const BoundedLength& found, const BoundedLength& expected) {
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.lower, expected.lower);
  EXPECT_EQ(found.upper, expected.upper);
  ASSERT_EQ(found.witness.has_value(), expected.witness.has_value());
  if (found.witness) {
    EXPECT_EQ(*found.witness, *expected.witness);
  }
}

template <class Answers>
auto find_pair(const Answers& answers, std::size_t a, std::size_t b) {
  return std::ranges::find_if(answers, [&](const auto& pair) { return pair.first == a && pair.second == b; });
}

void expect_contacts(std::span<const PairContacts> found, std::size_t a, std::size_t b,
                     const std::map<PartPair, std::vector<Contact>>& expected) {
  std::size_t entries = 0;
  for (const PairContacts& pair : found) {
    if (pair.first != a || pair.second != b) continue;
    ++entries;
    const auto at = expected.find(pair.parts);
    ASSERT_NE(at, expected.end());
    ASSERT_EQ(pair.contacts.size(), at->second.size());
    for (std::size_t k = 0; k < pair.contacts.size(); ++k) {
      EXPECT_EQ(pair.contacts[k].id, at->second[k].id);
      EXPECT_EQ(pair.contacts[k].point1, at->second[k].point1);
      EXPECT_EQ(pair.contacts[k].depth, at->second[k].depth);
    }
  }
  EXPECT_EQ(entries, expected.size());
}

TEST(CompoundBodies, AnswerAsTheirParts) {
  RandomPoses random(3);
  const Compounds bodies = compounds(random);
  MultiBodyQuery world(bodies, {.contact_margin = kCompoundMargin});
  std::vector<Transform> poses(bodies.size());
  std::size_t collisions = 0, apart = 0;
  for (int round = 0; round < 12; ++round) {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (round < 2 || b % 2 == 0) world.set_pose(b, poses[b] = random.pose(1.4));
    const std::span<const PairSeparation> separations = world.separations();
    const std::span<const PairDepth> depths = world.penetration_depths();
    ASSERT_EQ(separations.size(), bodies.size() * (bodies.size() - 1) / 2);
    for (std::size_t a = 0; a < bodies.size(); ++a)
      for (std::size_t b = a + 1; b < bodies.size(); ++b) {
        SCOPED_TRACE(std::to_string(round) + ": " + std::to_string(a) + " " + std::to_string(b));
        const Expected expected = expected_of(poses, bodies, a, b);
        const auto separation = find_pair(separations, a, b);
        expect_same_length(separation->separation, expected.separation);
        EXPECT_EQ(separation->parts, expected.nearest);
        EXPECT_EQ(separation->colliding, expected.colliding);
        EXPECT_EQ(find_pair(world.colliding(), a, b) != world.colliding().end(), expected.colliding);
        const auto depth = find_pair(depths, a, b);
        ASSERT_EQ(depth != depths.end(), expected.depth.has_value());
        if (expected.depth) {
          expect_same_length(depth->penetration_depth, *expected.depth);
          EXPECT_EQ(depth->parts, expected.deepest);
        }
        expect_contacts(world.contacts(), a, b, expected.contacts);
        collisions += expected.colliding;
        apart += !expected.colliding;
      }
  }
  EXPECT_GT(collisions, 20u);
  EXPECT_GT(apart, 20u);
}

TEST(CompoundBodies, OfOneShapeAreThatShape) {
  const Shape ball(sphere(1)), box(cube(0.6));
  RandomPoses random(4);
  MultiBodyQuery plain({ball, box, box}, {.contact_margin = kCompoundMargin});
  MultiBodyQuery world(Compounds{{{ball}}, {{box}}, {{box}}}, {.contact_margin = kCompoundMargin});
  for (int round = 0; round < 20; ++round) {
    for (std::size_t b = 0; b < 3; ++b) {
      const Transform pose = random.pose(0.8);
      plain.set_pose(b, pose);
      world.set_pose(b, pose);
      EXPECT_EQ(plain.pose(b).rows, world.pose(b).rows);
    }
    const auto expected = plain.separations(), found = world.separations();
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      expect_same_length(found[i].separation, expected[i].separation);
  }
}

// The filters are those of bodies, and parts of one are no pair.
TEST(CompoundBodies, ArePairsAsTheirFiltersSay) {
  const Shape box(cube(0.5));
  const std::vector<BodyPart> two{{box}, {box, Transform::translation({0.3, 0, 0})}};
  MultiBodyQuery world(Compounds{two, two, {{box}}});
  ASSERT_EQ(world.size(), 3u);
  EXPECT_EQ(world.part_count(0), 2u);
  EXPECT_EQ(world.colliding().size(), 3u);
  world.exclude_pair(1, 0);
  ASSERT_EQ(world.colliding().size(), 2u);
  EXPECT_EQ(world.colliding()[0].second, 2u);
  world.set_filter(2, {.fixed = true});
  world.set_filter(1, {.fixed = true});
  ASSERT_EQ(world.colliding().size(), 1u);
  world.include_pair(0, 1);
  EXPECT_EQ(world.colliding().size(), 2u);
  EXPECT_TRUE(world.filter(1).fixed);
  world.set_pose(0, Transform::translation({9, 0, 0}));
  EXPECT_TRUE(world.colliding().empty());
}

TEST(CompoundBodies, ComeIntoContactWithTheirFirstPart) {
  const Shape box(cube(0.5));  // of side 1
  const std::vector<BodyPart> row{{box}, {box, Transform::translation({2, 0, 0})}};
  const MultiBodyQuery world(Compounds{row, {{box}}});
  const auto at = [](double x) { return Transform::translation({x, 0, 0}); };
  const std::array<Motion, 2> motions{{{at(0), at(10)}, {at(8), at(8)}}};
  const auto contacts = world.time_of_contact(motions, 1e-6);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].time_of_contact.time, 0.5, 1e-5);
  EXPECT_EQ(contacts[0].parts, (PartPair{1, 0}));
  EXPECT_NEAR(world.poses_at(motions, 0.5)[0].rows[0][3], 5, 1e-12);
}

// A row of two boxes turns by half a revolution about its middle, (1, 0, 0): no part passes a body that is
// beyond its reach, and the far box meets one that is beside its path.
TEST(CompoundBodies, TurnAboutTheMiddleOfAllParts) {
  const Shape box(cube(0.5));
  const std::vector<BodyPart> row{{box}, {box, Transform::translation({2, 0, 0})}};
  const MultiBodyQuery world(Compounds{row, {{box}}, {{box}}});
  const Transform turned = Transform::translation({2, 0, 0}) * Transform::rotation({0, 0, 180});
  const Transform beside = Transform::translation({1, 1.2, 0}), away = Transform::translation({1, 2.4, 0});
  const std::array<Motion, 3> motions{{{Transform{}, turned}, {beside, beside}, {away, away}}};
  const auto contacts = world.time_of_contact(motions, 1e-6);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].second, 1u);
  const double time = contacts[0].time_of_contact.time;
  MultiBodyQuery then(Compounds{row, {{box}}});
  const std::array motions_of_two{motions[0], motions[1]};
  then.set_poses(MultiBodyQuery(Compounds{row, {{box}}}).poses_at(motions_of_two, time));
  EXPECT_NEAR(then.separations()[0].separation.value, 0, 1e-5);
  EXPECT_EQ(then.separations()[0].parts[0], contacts[0].parts[0]);
}

// Within rounding of half a turn, the sign of an axis is that of rounding: parts must not choose it apart.
TEST(CompoundBodies, TurnTheSameWayInHalfTurns) {
  const Shape box(cube(0.1));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 60; ++round) {
    const auto number = [&] { return normal(random); };
    const Transform local =
        Transform::translation({2, 0, 0}) * Transform::quaternion({number(), number(), number(), number()});
    const std::vector<BodyPart> row{{box}, {box, local}};
    const MultiBodyQuery world(Compounds{row, {{box}}});
    // Not about the axis of the row, on which its parts would stay.
    const Transform end = Transform::quaternion({0, 0.1 * number(), number(), number()});
    const Transform middle = world.poses_at(std::array<Motion, 2>{{{Transform{}, end}, {}}}, 0.5)[0];
    const Transform in_the_way = middle * local;
    const std::array<Motion, 2> motions{{{Transform{}, end}, {in_the_way, in_the_way}}};
    const auto contacts = world.time_of_contact(motions, 1e-6);
    ASSERT_EQ(contacts.size(), 1u) << round;
    ASSERT_LT(contacts[0].time_of_contact.time, 0.5) << round;
  }
}

// A part that is deep inside a body is far from its surface, and another part, beyond the limit, is nearer.
TEST(CompoundBodies, SeparationsWithinALimitAreThoseWithout) {
  const Shape large(cube(10)), small(cube(0.5));
  for (const double limit : {std::numeric_limits<double>::infinity(), 3.0, 1.0, 0.1}) {
    MultiBodyQuery world(Compounds{{{large}}, {{small}, {small, Transform::translation({12.5, 0, 0})}}});
    const auto separations = world.separations(limit);
    ASSERT_EQ(separations.size(), 1u);
    EXPECT_EQ(separations[0].separation.value, 2) << limit;
    EXPECT_EQ(separations[0].parts, (PartPair{0, 1}));
    EXPECT_TRUE(separations[0].colliding);
  }
}

// A rotation rounded to float is corrected once, for the body, not for each part.
TEST(CompoundBodies, StayRigidInPosesOfSinglePrecision) {
  const Shape box(cube(0.5));
  const Transform local = Transform::translation({100, 0, 0});
  MultiBodyQuery world(Compounds{{{box}, {box, local}}});
  Transform pose = Transform::rotation({10, 20, 30});
  for (auto& row : pose.rows)
    for (double& x : row) x = static_cast<float>(x);
  world.set_pose(0, pose);
  const Transform part = world.part_pose(0, 1), expected = world.pose(0) * local;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(part.rows[i][j], expected.rows[i][j], 1e-13);
}

TEST(CompoundBodies, HaveMapsToThem) {
  const Shape mapped(cube(0.5), {.resolution = 64}), box(cube(0.5));
  const MultiBodyQuery world(Compounds{
      {{mapped}}, {{box, Transform::translation({-2, 0, 0})}, {box, Transform::translation({2, 0, 0})}}});
  const NearestMap nearest = world.nearest_map(0);
  ASSERT_EQ(nearest.part.size(), nearest.body.size());
  std::array<std::size_t, 2> texels{};
  for (std::size_t i = 0; i < nearest.body.size(); ++i)
    if (nearest.body[i] != kNone) {
      EXPECT_EQ(nearest.body[i], 1u);
      ++texels.at(nearest.part[i]);
    }
  EXPECT_GT(texels[0], 100u);
  EXPECT_GT(texels[1], 100u);
  EXPECT_THROW((void)world.nearest_map(1), Error);
  const std::vector<float> distances = nearest_distances_at_vertices(world, 1, 10);
  ASSERT_EQ(distances.size(), 16u);
  EXPECT_NEAR(*std::ranges::min_element(distances), 1, 1e-6);
}

// Tiles that are one body are a floor without internal edges, whether it is fixed or not.
TEST(CompoundBodies, HaveNoInternalEdgesBetweenTheirParts) {
  const Shape tile(cube(0.5)), slider(cube(0.6));
  std::vector<BodyPart> floor;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 4; ++j) floor.push_back({tile, Transform::translation({1.0 * i, 1.0 * j, -0.5})});
  const auto slanted = [&](bool ignore) {
    MultiBodyQuery world(Compounds{{{slider}}, floor},
                         {.contact_margin = 0.02, .ignore_internal_edges = ignore});
    std::size_t count = 0, supports = 0;
    for (int step = 0; step <= 30; ++step) {
      const double depth = step % 2 == 0 ? 0.01 : 0.05;
      world.set_pose(0, Transform::translation({1.5 + step / 15.0, 1.6, 0.6 - depth}) *
                            Transform::rotation({0, 0, 17.0 * (step % 3)}));
      for (const PairContacts& pair : world.contacts())
        for (const Contact& c : pair.contacts) ++(std::abs(c.normal[2]) < 0.996 ? count : supports);
    }
    EXPECT_GT(supports, 0u);
    return count;
  };
  EXPECT_GT(slanted(false), 0u);
  EXPECT_EQ(slanted(true), 0u);
}

TEST(CompoundBodies, RefuseWhatTheyCannotDo) {
  const Shape box(cube(0.5));
  EXPECT_THROW(MultiBodyQuery(Compounds{{{box}}, {}}), Error);
  Transform sheared;
  sheared.rows[0][1] = 1;
  EXPECT_THROW(MultiBodyQuery(Compounds{{{box, sheared}}}), Error);
  MultiBodyQuery world(Compounds{{{box}, {box, Transform::translation({2, 0, 0})}}, {{Shape(cube(0.2))}}});
  EXPECT_THROW(world.refit(0, box.sites().mesh().positions), Error);
  EXPECT_THROW((void)world.sites(0, 2), Error);
  EXPECT_THROW((void)world.part_pose(1, 1), Error);
  const Transform before = world.part_pose(0, 1);
  Transform far;
  far.rows[0][3] = 9.9e36;
  for (int i = 0; i < 3; ++i) far.rows[i][i] = 1e36;
  EXPECT_THROW(world.set_pose(0, far), Error);
  EXPECT_EQ(world.part_pose(0, 0).rows, Transform{}.rows) << "nothing changes";
  EXPECT_EQ(world.part_pose(0, 1).rows, before.rows);
}

}  // namespace
}  // namespace sdm::test

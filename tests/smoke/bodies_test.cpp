// Many bodies and many poses: one small case for each query, against single pairs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

class PosesAtRandom {
 public:
  explicit PosesAtRandom(unsigned seed) : random_(seed) {}
  Transform pose(double reach) {
    std::uniform_real_distribution<double> place(-reach, reach);
    std::normal_distribution<double> normal;
    return Transform::translation({place(random_), place(random_), place(random_)}) *
           Transform::quaternion({normal(random_), normal(random_), normal(random_), normal(random_)});
  }
  std::vector<Transform> poses(std::size_t count, double reach) {
    std::vector<Transform> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(pose(reach));
    return all;
  }

 private:
  std::mt19937 random_;
};

std::vector<Shape> seven_shapes() {
  const Shape ball(sphere(1)), box(cube(0.6));
  return {ball,
          box,
          Shape(tetrahedron()),
          Shape(first_faces(sphere(1), 17)),
          box,
          Shape(torus(7, 5)),
          Shape(single_triangle())};
}

void expect_equal_lengths(const BoundedLength& found, const BoundedLength& expected) {
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.lower, expected.lower);
  EXPECT_EQ(found.upper, expected.upper);
}

TEST(SmokeBodies, AnswersOfPairsAreThoseOfSingleQueries) {
  PosesAtRandom random(3);
  const std::vector<Shape> shapes = seven_shapes();
  MultiBodyQuery world(shapes, {.contact_margin = 0.05});
  ASSERT_EQ(world.size(), 7u);
  for (int step = 0; step < 3; ++step) {
    const std::vector<Transform> poses = random.poses(shapes.size(), 1.5);
    if (step == 2) {
      world.set_pose(3, poses[3]);
    } else {
      world.set_poses(poses);
    }
    std::size_t pairs = 0, colliding = 0, depths = 0, with_contacts = 0;
    for (std::uint32_t a = 0; a < 7; ++a)
      for (std::uint32_t b = a + 1; b < 7; ++b) {
        ProximityQuery query(shapes[a], shapes[b], {.contact_margin = 0.05});
        query.set_pose(0, world.pose(a));
        query.set_pose(1, world.pose(b));
        const PairSeparation& pair = world.separations()[pairs++];
        ASSERT_EQ(pair.first, a);
        ASSERT_EQ(pair.second, b);
        expect_equal_lengths(pair.separation, query.separation());
        EXPECT_EQ(pair.colliding, query.colliding());
        if (query.colliding()) {
          EXPECT_EQ(world.colliding()[colliding].first, a);
          EXPECT_EQ(world.colliding()[colliding++].second, b);
          if (query.penetration_depth())
            expect_equal_lengths(world.penetration_depths()[depths++].penetration_depth,
                                 *query.penetration_depth());
        }
        if (query.contacts().empty()) continue;
        const PairContacts& contacts = world.contacts()[with_contacts++];
        ASSERT_EQ(contacts.first, a);
        ASSERT_EQ(contacts.contacts.size(), query.contacts().size());
        for (std::size_t i = 0; i < contacts.contacts.size(); ++i) {
          EXPECT_EQ(contacts.contacts[i].depth, query.contacts()[i].depth);
          EXPECT_EQ(contacts.contacts[i].id, query.contacts()[i].id);
        }
      }
    EXPECT_EQ(world.separations().size(), pairs);
    EXPECT_EQ(world.candidate_pairs(), pairs);
    EXPECT_EQ(world.colliding().size(), colliding);
    EXPECT_EQ(world.penetration_depths().size(), depths);
    EXPECT_EQ(world.contacts().size(), with_contacts);
    EXPECT_GT(colliding, 3u);
    const std::size_t all = pairs;
    std::size_t near = 0;
    std::vector<double> values;
    for (const PairSeparation& pair : world.separations()) values.push_back(pair.separation.value);
    for (const double value : values) near += value <= 0.4;
    EXPECT_EQ(world.separations(0.4).size(), near);
    EXPECT_LT(near, all);
  }
  EXPECT_THAT(MultiBodyQuery(std::vector<Shape>{}).colliding(), ::testing::IsEmpty());
}

TEST(SmokeBodies, FiltersLeaveOutPairs) {
  const Shape box(cube(0.5));
  MultiBodyQuery world(std::vector<Shape>(5, box));
  for (std::size_t i = 0; i < 5; ++i)
    world.set_pose(i, Transform::translation({0.1 * static_cast<double>(i), 0, 0}));
  EXPECT_EQ(world.colliding().size(), 10u);
  world.set_filter(0, {.fixed = true});
  world.set_filter(1, {.fixed = true});
  world.exclude_pair(2, 3);
  EXPECT_EQ(world.colliding().size(), 8u);
  EXPECT_TRUE(world.filter(0).fixed);
  world.include_pair(3, 2);
  world.set_filter(4, {.groups = 2, .mask = 2});
  EXPECT_EQ(world.colliding().size(), 5u);
}

TEST(SmokeBodies, CompoundsAnswerForAllOfTheirParts) {
  PosesAtRandom random(8);
  const Shape ball(sphere(1)), box(cube(0.4));
  std::vector<std::vector<BodyPart>> bodies(3);
  for (int i = 0; i < 3; ++i) bodies[0].push_back({i == 1 ? ball : box, random.pose(1)});
  bodies[1] = {{box, random.pose(0.5)}, {Shape(first_faces(sphere(1), 15)), random.pose(0.5)}};
  bodies[2] = {{ball}};
  MultiBodyQuery world(bodies, {.contact_margin = 0.05});
  EXPECT_EQ(world.part_count(0), 3u);
  world.set_pose(1, Transform::translation({0.9, 0.3, 0}));
  world.set_pose(2, Transform::translation({-1.2, 0.2, 1.5}));
  std::size_t number = 0;
  for (std::uint32_t a = 0; a < 3; ++a)
    for (std::uint32_t b = a + 1; b < 3; ++b) {
      double separation = std::numeric_limits<double>::infinity();
      bool colliding = false;
      std::size_t contacts = 0;
      for (std::size_t i = 0; i < bodies[a].size(); ++i)
        for (std::size_t j = 0; j < bodies[b].size(); ++j) {
          ProximityQuery query(bodies[a][i].shape, bodies[b][j].shape, {.contact_margin = 0.05});
          query.set_pose(0, world.part_pose(a, i));
          query.set_pose(1, world.part_pose(b, j));
          separation = std::min(separation, query.separation().value);
          colliding = colliding || query.colliding();
          contacts += query.contacts().size();
        }
      const PairSeparation& pair = world.separations()[number++];
      EXPECT_NEAR(pair.separation.value, separation, 1e-9);
      EXPECT_EQ(pair.colliding, colliding);
      std::size_t found = 0;
      for (const PairContacts& entry : world.contacts())
        if (entry.first == a && entry.second == b) found += entry.contacts.size();
      EXPECT_EQ(found, contacts);
    }
  EXPECT_FALSE(world.penetration_depths().empty());
  EXPECT_GT(world.sites(0, 1).mesh().triangles.size(), 12u);
  const std::vector<float> distances = nearest_distances_at_vertices(world, 2, 100);
  ASSERT_EQ(distances.size(), sphere(1).positions.size());
  for (std::size_t v = 0; v < distances.size(); ++v) {
    const Vec3 p = world.pose(2)(sphere(1).positions[v]);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t body = 0; body < 2; ++body)
      for (std::size_t part = 0; part < world.part_count(body); ++part) {
        Mesh mesh = world.sites(body, part).mesh();
        transform(mesh, world.part_pose(body, part));
        nearest = std::min(nearest, oracle::brute_force(mesh, p));
      }
    EXPECT_NEAR(std::abs(distances[v]), nearest, 1e-5);
  }
  std::vector<Motion> motions(3);
  for (std::size_t i = 0; i < 3; ++i) motions[i] = {.from = world.pose(i), .to = world.pose(i)};
  motions[2].from = Transform::translation({-9, 0, 0});
  motions[2].to = {};
  bool met = false;
  for (const PairTimeOfContact& pair : world.time_of_contact(motions, 1e-4))
    met = met || (pair.first == 0 && pair.second == 2 && pair.time_of_contact.time > 0.1);
  EXPECT_TRUE(met);
}

// Boxes on a floor of tiles, which are bodies of their own: no contact pushes to a side.
TEST(SmokeBodies, TilesOfAFloorDoNotCatchABox) {
  std::vector<Shape> shapes{Shape(box({-0.6, -0.6, 0}, {0.6, 0.6, 0.6}))};
  for (int i = 0; i < 3; ++i) shapes.emplace_back(box({1.0 * i, 0, -1}, {i + 1.0, 3, 0}));
  MultiBodyQuery world(shapes, {.contact_margin = 0.02, .ignore_internal_edges = true});
  for (std::size_t i = 1; i < 4; ++i) world.set_filter(i, {.fixed = true});
  for (int step = 0; step < 4; ++step) {
    world.set_pose(0, Transform::translation({0.9 + 0.3 * step, 1.5, -0.03}));
    std::size_t count = 0;
    for (const PairContacts& pair : world.contacts())
      for (const Contact& c : pair.contacts) {
        EXPECT_GT(std::abs(c.normal[2]), 0.99);
        ++count;
      }
    EXPECT_GE(count, 4u);
  }
}

TEST(SmokeBodies, FollowDeformation) {
  std::vector<Mesh> meshes{sphere(1), cube(0.5), torus(7, 5)};
  MultiBodyQuery world(meshes);
  world.set_pose(1, Transform::translation({1.2, 0, 0}));
  (void)world.separations();
  meshes[0] = mapped_by(meshes[0], [](const Vec3& p) { return 0.5 * p; });
  meshes[2] = mapped_by(meshes[2], [](const Vec3& p) { return p + Vec3{0, 0, 0.3}; });
  world.refit(0, meshes[0].positions);
  const std::vector<std::span<const Vec3>> positions{{}, {}, meshes[2].positions};
  world.refit(positions);
  MultiBodyQuery expected(meshes);
  expected.set_pose(1, world.pose(1));
  ASSERT_EQ(world.separations().size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(world.separations()[i].separation.value, expected.separations()[i].separation.value);
    EXPECT_EQ(world.separations()[i].colliding, expected.separations()[i].colliding);
  }
}

TEST(SmokeBodies, FirstContactsOfManyAreThoseOfEachPair) {
  PosesAtRandom random(5);
  const std::vector<Shape> shapes = seven_shapes();
  const MultiBodyQuery world(shapes);
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    motions.push_back({.from = random.pose(6), .to = random.pose(6)});
  const std::vector<PairTimeOfContact> found = world.time_of_contact(motions, 1e-4);
  std::size_t expected = 0;
  for (std::uint32_t a = 0; a < shapes.size(); ++a)
    for (std::uint32_t b = a + 1; b < shapes.size(); ++b) {
      const TimeOfContact pair = time_of_contact(shapes[a], motions[a], shapes[b], motions[b], 1e-4);
      const auto at =
          std::ranges::find_if(found, [&](const auto& f) { return f.first == a && f.second == b; });
      EXPECT_EQ(at != found.end(), pair.contact);
      expected += pair.contact;
      if (at != found.end()) {
        EXPECT_EQ(at->time_of_contact.time, pair.time);
      }
    }
  EXPECT_EQ(found.size(), expected);
  ASSERT_GT(expected, 0u);
  EXPECT_TRUE(std::ranges::is_sorted(found, {}, [](const auto& f) { return f.time_of_contact.time; }));
  const std::vector<PairTimeOfContact> first = world.time_of_contact(motions, 1e-4, {.earliest_only = true});
  ASSERT_GE(first.size(), 1u);
  EXPECT_EQ(first[0].time_of_contact.time, found[0].time_of_contact.time);
  const std::vector<Transform> poses = world.poses_at(motions, 0.5);
  EXPECT_EQ(poses[2].rows, motions[2].at(0.5, shapes[2]).rows);
}

TEST(SmokeBodies, NearestMapsAreToTheNearestBody) {
  const std::vector<Mesh> meshes{sphere(1), cube(0.5), torus(7, 5)};
  MultiBodyQuery world(with_atlases(meshes, 40));
  const std::vector<Transform> poses{
      {}, Transform::translation({1.6, 0, 0}), Transform::translation({0, 0.5, -2})};
  world.set_poses(poses);
  NearestMap nearest;
  world.nearest_map(0, 2.0, nearest);
  const Surface& surface = world.surface(0);
  for (const std::uint32_t t : surface.sample_texels()) {
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t body = kNone;
    for (std::uint32_t b = 1; b < 3; ++b) {
      Mesh mesh = meshes[b];
      transform(mesh, poses[b]);
      const double d = oracle::brute_force(mesh, surface.texel_point(t));
      if (d < least) {
        least = d;
        body = b;
      }
    }
    if (least > 2 - 1e-5) continue;
    EXPECT_NEAR(std::abs(nearest.map.distance[t]), least, 1e-5);
    EXPECT_TRUE(nearest.body[t] == body || std::abs(least - std::abs(nearest.map.distance[t])) < 1e-6);
  }
  EXPECT_EQ(world.nearest_map(0).map.beyond_max_distance, 0u);
}

TEST(SmokePoses, BatchesHaveTheAnswersOfSinglePoses) {
  PosesAtRandom random(6);
  const Shape ball(mapped_by(sphere(0),
                             [](const Vec3&p) {
                               return Vec3{p[0], 0.5 * p[1], 0.6 * p[2]};
                             })),
      tetra(tetrahedron()), open(first_faces(sphere(1), 17)), ring_shape(torus(7, 5)), box(cube(0.5));
  const std::vector<std::pair<Shape, std::vector<Shape>>> cases{
      {ball, {box}}, {box, {tetra, ball}}, {open, {ring_shape}}, {ring_shape, {box, open, tetra}}, {box, {}}};
  for (const auto& [shape, obstacles] : cases) {
    PoseQuery query(shape, obstacles);
    for (std::size_t i = 0; i < obstacles.size(); ++i)
      query.set_pose(i, Transform::translation({0.7 * static_cast<double>(i), 0.1, 0}));
    for (const std::size_t count : {0, 1, 2, 5, 17, 41}) {
      const std::vector<Transform> poses = random.poses(count, 1.5);
      const std::vector<std::uint8_t> colliding = query.colliding(poses);
      const std::vector<double> separations = query.separations(poses), near = query.separations(poses, 0.5);
      const std::vector<BoundedNumber> depths =
          count > 5 ? std::vector<BoundedNumber>(count) : query.penetration_depths(poses);
      ASSERT_EQ(colliding.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        bool any = false;
        double least = std::numeric_limits<double>::infinity();
        std::optional<double> deepest;
        for (std::size_t k = 0; k < obstacles.size(); ++k) {
          ProximityQuery pair(shape, obstacles[k]);
          pair.set_pose(0, poses[i]);
          pair.set_pose(1, Transform::translation({0.7 * static_cast<double>(k), 0.1, 0}));
          any = any || pair.colliding();
          least = std::min(least, pair.separation().value);
          if (count <= 5 && pair.penetration_depth())
            deepest = std::max(deepest.value_or(0), pair.penetration_depth()->value);
        }
        EXPECT_EQ(colliding[i] != 0, any);
        EXPECT_EQ(separations[i], least);
        EXPECT_EQ(near[i], least <= 0.5 ? least : std::numeric_limits<double>::infinity());
        if (count <= 5) {
          EXPECT_EQ(std::isnan(depths[i].value), !deepest);
        }
        if (count <= 5 && deepest) {
          EXPECT_EQ(depths[i].value, *deepest);
        }
      }
    }
  }
}

}  // namespace
}  // namespace sdm::test

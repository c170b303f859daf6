// How the bodies of a world leave each other, against single calls for its pairs, and over tiles of several
// bodies.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <span>
#include <vector>

#include "geometry/vec.h"
#include "scenes/blocks.h"
#include "scenes/box_mesh.h"
#include "scenes/rigid_world.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr double kWorldMargin = 0.03;

void expect_equal(std::span<const Contact> found, std::span<const Contact> expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].id, expected[i].id);
    EXPECT_EQ(found[i].patch, expected[i].patch);
    EXPECT_EQ(found[i].depth, expected[i].depth);
    EXPECT_EQ(found[i].normal, expected[i].normal);
    EXPECT_EQ(found[i].point1, expected[i].point1);
    EXPECT_EQ(found[i].point2, expected[i].point2);
  }
}

// Convex and other solids, and a surface.
std::vector<Shape> shapes_of_a_world() {
  Mesh sheet = cube(0.8);
  sheet.triangles.resize(4);
  return {
      Shape(sphere(1)),    Shape(cube(0.6)),
      Shape(ring(8, 0.7)), Shape(tetrahedron()),
      Shape(sheet),        Shape(scenes::union_of({{{-1, -1, -1}, {1, 1, 0}}, {{-1, -1, 0}, {0, 0, 1}}}))};
}

class RandomWorld {
 public:
  explicit RandomWorld(unsigned seed) : random_(seed) {}
  Transform pose(double reach) {
    std::uniform_real_distribution<double> place(-reach, reach);
    std::normal_distribution<double> normal;
    return Transform::translation({place(random_), place(random_), place(random_)}) *
           Transform::quaternion({normal(random_), normal(random_), normal(random_), normal(random_)});
  }

 private:
  std::mt19937 random_;
};

// The answers of all pairs that are asked for, some of which did not move since the last call.
TEST(SeparatingWorlds, HaveTheAnswersOfTheirPairs) {
  const std::vector<Shape> shapes = shapes_of_a_world();
  RandomWorld random(3);
  MultiBodyQuery world(shapes, {.contact_margin = kWorldMargin});
  world.set_filter(1, {.groups = 2});
  world.set_filter(2, {.mask = 1});  // not with 1
  world.exclude_pair(0, 3);
  world.set_filter(4, {.fixed = true});
  world.set_filter(5, {.fixed = true});
  const auto is_pair = [](std::size_t a, std::size_t b) {
    return !(a == 1 && b == 2) && !(a == 0 && b == 3) && !(a == 4 && b == 5);
  };
  std::size_t colliding = 0, touching = 0;
  for (int round = 0; round < 12; ++round) {
    for (std::size_t b = 0; b < shapes.size(); ++b)
      if (round % 3 == 0 || b == 2) world.set_pose(b, random.pose(1.1));
    std::vector<PairTranslation> translations;
    std::map<std::array<std::size_t, 2>, std::vector<Contact>> contacts, few;
    for (std::size_t a = 0; a < shapes.size(); ++a)
      for (std::size_t b = a + 1; b < shapes.size(); ++b) {
        if (!is_pair(a, b)) continue;
        ProximityQuery pair(shapes[a], shapes[b], {.contact_margin = kWorldMargin});
        pair.set_pose(0, world.pose(a));
        pair.set_pose(1, world.pose(b));
        if (pair.colliding())
          translations.push_back(
              {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), pair.separating_translation()});
        for (const Contact& c : pair.separating_contacts()) contacts[{a, b}].push_back(c);
        for (const Contact& c : pair.separating_contacts(2)) few[{a, b}].push_back(c);
      }
    if (round % 2 == 0) (void)world.contacts();
    const std::span<const PairTranslation> found = world.separating_translations();
    ASSERT_EQ(found.size(), translations.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].first, translations[i].first);
      EXPECT_EQ(found[i].second, translations[i].second);
      const SeparatingTranslation &of_pair = found[i].separating_translation,
                                  &expected = translations[i].separating_translation;
      EXPECT_EQ(of_pair.translation, expected.translation);
      EXPECT_EQ(of_pair.lower, expected.lower);
      EXPECT_EQ(of_pair.upper, expected.upper);
      EXPECT_EQ(of_pair.certainty, expected.certainty);
    }
    for (const auto& [most, all] : {std::pair(std::optional<std::size_t>(2), &few),
                                    std::pair(std::optional<std::size_t>(), &contacts)}) {
      const std::span<const PairContacts> pairs = world.separating_contacts(most);
      ASSERT_EQ(pairs.size(), all->size());
      for (const PairContacts& pair : pairs) expect_equal(pair.contacts, (*all)[{pair.first, pair.second}]);
    }
    colliding += found.size();
    touching += contacts.size();
  }
  EXPECT_GT(colliding, 40u);
  EXPECT_GT(touching, colliding);
  EXPECT_THROW((void)world.separating_contacts(0), Error);
}

// One translation of all parts, verified with the poses that a caller sets, that meets all contacts.
TEST(SeparatingWorlds, MoveCompoundsApartAsAWhole) {
  const Shape ball(sphere(1)), box(cube(0.5)),
      corner(scenes::union_of({{{-1, -1, -1}, {1, 1, 0}}, {{-1, -1, 0}, {0, 0, 1}}}));
  RandomWorld random(9);
  const std::vector<std::vector<BodyPart>> bodies{
      {{ball, random.pose(0.8)}, {box, random.pose(0.8)}, {corner, random.pose(0.4)}},
      {{box, random.pose(0.6)}, {box, random.pose(0.6)}},
      {{corner}}};
  MultiBodyQuery world(bodies, {.contact_margin = kWorldMargin});
  std::size_t colliding = 0, several = 0;
  for (int round = 0; round < 12; ++round) {
    std::vector<Transform> poses;
    for (std::size_t b = 0; b < bodies.size(); ++b) poses.push_back(random.pose(0.8));
    world.set_poses(poses);
    const std::span<const PairTranslation> spans = world.separating_translations();
    const std::vector<PairTranslation> translations(spans.begin(), spans.end());
    EXPECT_EQ(translations.size(), world.colliding().size());
    std::map<std::array<std::uint32_t, 2>, std::size_t> exits;
    for (const PairContacts& pair : world.separating_contacts()) {
      const auto out = std::ranges::find_if(translations, [&](const PairTranslation& t) {
        return t.first == pair.first && t.second == pair.second;
      });
      if (out == translations.end()) continue;
      for (const Contact& c : pair.contacts) {
        EXPECT_LE(c.depth, dot(c.normal, out->separating_translation.translation) + 1e-9);
        exits[{pair.first, pair.second}] += c.id == ProximityQuery::kExitContact;
      }
    }
    for (const PairTranslation& pair : translations) {
      EXPECT_GE((exits[{pair.first, pair.second}]), 1u) << "the nearest parts";
      const SeparatingTranslation& out = pair.separating_translation;
      EXPECT_NEAR(norm(out.translation), out.upper, 1e-12);
      EXPECT_LE(out.lower, out.upper);
      EXPECT_GT(out.upper, 0);
      double largest = 0;
      std::size_t parts = 0;
      for (std::size_t i = 0; i < bodies[pair.first].size(); ++i)
        for (std::size_t j = 0; j < bodies[pair.second].size(); ++j) {
          ProximityQuery alone(bodies[pair.first][i].shape, bodies[pair.second][j].shape);
          alone.set_pose(0, world.part_pose(pair.first, i));
          alone.set_pose(1, world.part_pose(pair.second, j));
          largest = std::max(largest, alone.separating_translation().lower);
          parts += alone.colliding();
        }
      EXPECT_NEAR(out.lower, std::min(largest, out.upper), 1e-12);
      world.set_pose(pair.first, Transform::translation(out.translation) * poses[pair.first]);
      EXPECT_TRUE(std::ranges::none_of(world.colliding(), [&](const BodyPair& found) {
        return found.first == pair.first && found.second == pair.second;
      }));
      world.set_pose(pair.first, poses[pair.first]);
      several += parts > 1;
    }
    colliding += translations.size();
  }
  EXPECT_GT(colliding, 15u);
  EXPECT_GT(several, 8u);
}

constexpr int kRow = 12;

// A box of side 1.2 on tiles of 1 × 3 × 1, which are bodies of their own before and after it.
std::vector<scenes::RigidStart> box_on_tiles(double gap, double depth, const Vec3& velocity) {
  std::vector<scenes::RigidStart> bodies;
  for (int i = 0; i < kRow; ++i) {
    if (i == kRow / 2)
      bodies.push_back({.shape = Shape(scenes::box_mesh({{-0.6, -0.6, 0}, {0.6, 0.6, 0.6}})),
                        .pose = Transform::translation({0.7, 0, -depth}),
                        .velocity = velocity});
    bodies.push_back(
        {.shape = Shape(scenes::box_mesh({{i + gap, -1.5, -1}, {i + 1 - gap, 1.5, 0}})), .fixed = true});
  }
  return bodies;
}

// Regression: in a query of each pair, the shortest way out of a tile that is overlapped by little is back.
TEST(SeparatingWorlds, LetABoxSlideOverTiles) {
  for (const double gap : {0.0, 1e-7})
    for (const double depth : {-0.004, 0.0, 0.004}) {
      scenes::RigidWorld world(
          box_on_tiles(gap, depth, {3, 0, 0}),
          {.friction = 0, .margin = 0.02, .separating = true, .ignore_internal_edges = true});
      for (int step = 0; step < 700; ++step) world.step();  // 8.75 tiles
      EXPECT_NEAR(world.velocity(kRow / 2)[0], 3, 1e-7) << gap << " " << depth;
      EXPECT_NEAR(world.velocity(kRow / 2)[2], 0, 1e-7) << gap << " " << depth;
    }
}

// The way out of a tile and its neighbours is up, for either order of the bodies and in a compound of tiles.
TEST(SeparatingWorlds, LeaveTilesUpwards) {
  const Shape box(scenes::box_mesh({{-0.6, -0.6, 0}, {0.6, 0.6, 0.6}}));
  std::vector<Shape> tiles;
  for (int i = 0; i < 3; ++i) tiles.emplace_back(scenes::box_mesh({{1.0 * i, -1.5, -1}, {i + 1.0, 1.5, 0}}));
  std::vector<BodyPart> floor;
  for (const Shape& tile : tiles) floor.push_back({tile});
  const ProximityOptions options{.contact_margin = kWorldMargin, .ignore_internal_edges = true};
  std::vector<MultiBodyQuery> worlds;
  worlds.emplace_back(std::vector<Shape>{box, tiles[0], tiles[1], tiles[2]}, options);
  worlds.emplace_back(std::vector<Shape>{tiles[0], tiles[1], tiles[2], box}, options);
  worlds.emplace_back(std::vector<std::vector<BodyPart>>{{{box}}, floor}, options);
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    MultiBodyQuery& world = worlds[w];
    const std::size_t moves = w == 1 ? 3 : 0;
    for (std::size_t b = 0; b < world.size(); ++b) world.set_filter(b, {.fixed = b != moves});
    // Over the second and third tile by 0.002 and more, 0.01 deep.
    for (const double x : {1.402, 1.45, 1.598}) {
      world.set_pose(moves, Transform::translation({x, 0, -0.01}));
      const std::span<const PairTranslation> translations = world.separating_translations();
      ASSERT_FALSE(translations.empty());
      for (const PairTranslation& pair : translations) {
        const double up = w == 1 ? -1 : 1;
        EXPECT_NEAR(up * pair.separating_translation.translation[2], 0.01, 1e-6);
        EXPECT_NEAR(pair.separating_translation.upper, 0.01, 1e-6);
      }
      std::size_t contacts = 0;
      for (const PairContacts& pair : world.separating_contacts())
        for (const Contact& c : pair.contacts) {
          EXPECT_GT(std::abs(c.normal[2]), 0.999);
          EXPECT_NEAR(c.depth, 0.01, 1e-6);
          ++contacts;
        }
      EXPECT_GE(contacts, 8u) << x;
    }
  }
  // Without the neighbour, the way out is to where it was.
  MultiBodyQuery& world = worlds[0];
  world.set_pose(0, Transform::translation({1.598, 0, -0.01}));
  ASSERT_EQ(world.separating_translations().size(), 3u);
  world.set_pose(2, Transform::translation({0, 0, -5}));
  for (const PairTranslation& pair : world.separating_translations())
    if (pair.second == 1) {
      EXPECT_NEAR(pair.separating_translation.upper, 0.002, 1e-6);
    }
  EXPECT_EQ(world.separating_translations().size(), 2u);
}

}  // namespace
}  // namespace sdm::test

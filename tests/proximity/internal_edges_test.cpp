// Contacts of a box that slides over floors of many triangles and of many tiles, and those at convex edges.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "scenes/box_mesh.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr int kTiles = 8;
constexpr double kSlideMargin = 0.02;
constexpr double kVertical = 0.996;  // to 5°

Mesh brick(const Vec3& lo, const Vec3& hi) {
  return scenes::box_mesh({lo, hi});
}

// Squares of side 1 at the height of a function, each of two triangles.
template <class Height>
Mesh floor_of(const Height& height) {
  Mesh mesh;
  for (int i = 0; i <= kTiles; ++i)
    for (int j = 0; j <= kTiles; ++j) mesh.positions.push_back({1.0 * i, 1.0 * j, height(i, j)});
  const auto vertex = [](int i, int j) { return static_cast<std::uint32_t>(i * (kTiles + 1) + j); };
  for (int i = 0; i < kTiles; ++i)
    for (int j = 0; j < kTiles; ++j)
      mesh.triangles.insert(mesh.triangles.end(), {{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)},
                                                   {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)}});
  return mesh;
}

// The floor, with walls and a bottom at z = −1.
Mesh solid_of(const Mesh& floor) {
  Mesh mesh = floor;
  const auto count = static_cast<std::uint32_t>(floor.positions.size());
  for (const Vec3& p : floor.positions) mesh.positions.push_back({p[0], p[1], -1});
  for (const auto& [a, b, c] : floor.triangles) mesh.triangles.push_back({c + count, b + count, a + count});
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const Triangle& t : floor.triangles)
    for (int i = 0; i < 3; ++i) edges.push_back({t[i], t[(i + 1) % 3]});
  std::ranges::sort(edges);
  for (const auto& [a, b] : edges)
    if (!std::ranges::binary_search(edges, std::array{b, a}))
      mesh.triangles.insert(mesh.triangles.end(), {{b, a, a + count}, {b, a + count, b + count}});
  return mesh;
}

std::vector<Shape> tiles(double gap = 0) {
  std::vector<Shape> shapes;
  for (int i = 0; i < kTiles; ++i)
    for (int j = 0; j < kTiles; ++j)
      shapes.emplace_back(brick({i + gap, j + gap, -1}, {i + 1.0 - gap, j + 1.0 - gap, 0}));
  return shapes;
}

// Body 0 on fixed others.
MultiBodyQuery world_of(const Shape& body, const std::vector<Shape>& floor, bool ignore) {
  std::vector<Shape> shapes{body};
  shapes.insert(shapes.end(), floor.begin(), floor.end());
  MultiBodyQuery world(shapes, {.contact_margin = kSlideMargin, .ignore_internal_edges = ignore});
  for (std::size_t b = 1; b < shapes.size(); ++b) world.set_filter(b, {.fixed = true});
  return world;
}

struct Slide {
  std::size_t poses = 0, supported = 0;  // with contacts on both sides of the middle
  std::size_t contacts = 0, slanted = 0;
};

// Of a box of side 1.2, in steps, turned and a little tilted, at this depth.
Slide slide(MultiBodyQuery& world, double depth) {
  Slide result;
  for (int step = 0; step <= 60; ++step)
    for (const Vec3& turn : {Vec3{0, 0, 0}, Vec3{0, 0, 17}, Vec3{0.5, 0, 17}}) {
      const Vec3 at{1.5 + step / 12.0, 4.3, -depth};
      world.set_pose(0, Transform::translation(at) * Transform::rotation(turn));
      double least = 1, most = -1;
      for (const PairContacts& pair : world.contacts())
        for (const Contact& c : pair.contacts) {
          ++result.contacts;
          result.slanted += std::abs(c.normal[2]) < kVertical;  // a floor without an inside has two sides
          least = std::min(least, c.point1[0] - at[0]);
          most = std::max(most, c.point1[0] - at[0]);
        }
      ++result.poses;
      result.supported += least < -0.3 && most > 0.3;
    }
  return result;
}

TEST(InternalEdges, DoNotCatchABoxThatSlides) {
  const Shape box(brick({-0.6, -0.6, 0}, {0.6, 0.6, 0.6}));
  const Mesh flat = floor_of([](int, int) { return 0.0; });
  const std::vector<std::vector<Shape>> floors{{Shape(flat)}, {Shape(solid_of(flat))}, tiles(), tiles(1e-7)};
  for (const std::vector<Shape>& floor : floors) {
    std::size_t caught = 0;
    for (const double depth : {-0.008, 0.0, 1e-3, 0.01, 0.05}) {
      MultiBodyQuery plain = world_of(box, floor, false), world = world_of(box, floor, true);
      const Slide before = slide(plain, depth), found = slide(world, depth);
      EXPECT_EQ(found.slanted, 0u) << floor.size() << " " << depth;
      EXPECT_EQ(found.supported, found.poses) << floor.size() << " " << depth;
      EXPECT_EQ(before.contacts - before.slanted, found.contacts)
          << "only those that are slanted are left out";
      caught += before.slanted;
    }
    EXPECT_GT(caught, 0u);
  }
}

// The steps of stairs, each a body of its own, push up and back.
TEST(InternalEdges, KeepTheCornersOfStairs) {
  std::vector<Shape> stairs;
  for (int i = 0; i < 3; ++i) stairs.emplace_back(brick({1.0 * i, 0, -1}, {i + 1.0, 3, 0.5 * i}));
  const Shape box(brick({-0.3, -0.3, 0}, {0.3, 0.3, 0.3}));
  MultiBodyQuery world = world_of(box, stairs, true);
  world.set_pose(0, Transform::translation({0.705, 1.5, -0.005}));  // on the first, against the second
  bool up = false, back = false;
  for (const PairContacts& pair : world.contacts())
    for (const Contact& c : pair.contacts) {
      up |= c.normal[2] > 0.999;
      back |= c.normal[0] < -0.999;
    }
  EXPECT_TRUE(up);
  EXPECT_TRUE(back);
}

// Nothing is flat or concave there, and nothing is fixed.
TEST(InternalEdges, LeaveConvexBodiesAsTheyAre) {
  const std::vector<Shape> shapes{Shape(sphere(2)), Shape(cube(0.5)), Shape(tetrahedron())};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.8, 0.8);
  std::normal_distribution<double> normal;
  std::size_t contacts = 0;
  for (int round = 0; round < 30; ++round) {
    MultiBodyQuery plain(shapes, {.contact_margin = kSlideMargin});
    MultiBodyQuery world(shapes, {.contact_margin = kSlideMargin, .ignore_internal_edges = true});
    for (std::size_t b = 0; b < shapes.size(); ++b) {
      const Transform pose =
          Transform::translation({place(random), place(random), place(random)}) *
          Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
      plain.set_pose(b, pose);
      world.set_pose(b, pose);
    }
    const auto expected = plain.contacts(), found = world.contacts();
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].contacts.size(), expected[i].contacts.size());
      for (std::size_t k = 0; k < found[i].contacts.size(); ++k)
        EXPECT_EQ(found[i].contacts[k].id, expected[i].contacts[k].id);
      contacts += found[i].contacts.size();
    }
  }
  EXPECT_GT(contacts, 100u);
}

// A ridge is no internal edge, the bottom of a groove is one.
TEST(InternalEdges, KeepRidges) {
  const Shape box(brick({-0.6, -0.6, 0}, {0.6, 0.6, 0.6}));
  const Mesh ridge = floor_of([](int i, int) { return i == kTiles / 2 ? 0.2 : 0.0; });
  for (const Mesh& floor : {ridge, solid_of(ridge)}) {
    MultiBodyQuery world = world_of(box, {Shape(floor)}, true);
    world.set_pose(0, Transform::translation({4, 4.3, 0.19}));  // on the ridge
    ASSERT_EQ(world.contacts().size(), 1u);
    for (const Contact& c : world.contacts()[0].contacts) EXPECT_GT(std::abs(c.normal[2]), 0.9);
  }
}

// Of two bodies, contacts() leaves out what a world of the two leaves out.
TEST(InternalEdges, AreThoseOfAWorldInAQueryOfTwo) {
  const Shape box(brick({-0.6, -0.6, 0}, {0.6, 0.6, 0.6}));
  const Shape floor(solid_of(floor_of([](int, int) { return 0.0; })));
  ProximityQuery plain(box, floor, {.contact_margin = kSlideMargin});
  ProximityQuery pair(box, floor, {.contact_margin = kSlideMargin, .ignore_internal_edges = true});
  MultiBodyQuery world({box, floor}, {.contact_margin = kSlideMargin, .ignore_internal_edges = true});
  std::size_t left_out = 0;
  for (int step = 0; step <= 20; ++step) {
    const Transform pose =
        Transform::translation({2 + step / 7.0, 4.3, -0.03}) * Transform::rotation({0, 0, 17});
    plain.set_pose(0, pose);
    pair.set_pose(0, pose);
    world.set_pose(0, pose);
    const std::span<const Contact> found = pair.contacts();
    ASSERT_EQ(world.contacts().size(), 1u);
    const std::span<const Contact> expected = world.contacts()[0].contacts;
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].id, expected[i].id);
      EXPECT_EQ(found[i].normal, expected[i].normal);
    }
    EXPECT_EQ(pair.contacts().size(), found.size()) << "the second call";
    left_out += plain.contacts().size() - found.size();
  }
  EXPECT_GT(left_out, 0u);
}

// Beside a box that is moved up out of a floor, vertices of the floor are closest to the walls of the box. A
// dent in its bottom makes the floor one that is not convex: contacts of convex solids are all along the way
// out.
TEST(InternalEdges, AreNoneOfTheContactsThatPushApart) {
  const Shape box(brick({-0.6, -0.6, 0}, {0.6, 0.6, 0.6}));
  const Mesh plate = solid_of(floor_of([](int, int) { return 0.0; }));
  Mesh dented = plate;
  dented.positions[dented.positions.size() / 2 + kTiles + 2][2] = -0.9;
  const Shape floor(dented);
  ASSERT_FALSE(floor.convex());
  ProximityQuery convex(box, Shape(plate), {.contact_margin = kSlideMargin});
  ProximityQuery plain(box, floor, {.contact_margin = kSlideMargin});
  ProximityQuery pair(box, floor, {.contact_margin = kSlideMargin, .ignore_internal_edges = true});
  const auto sideways = [](std::span<const Contact> contacts) {
    return std::ranges::count_if(contacts,
                                 [](const Contact& c) { return std::abs(c.normal[2]) < kVertical; });
  };
  std::ptrdiff_t left_out = 0;
  for (int step = 0; step <= 20; ++step) {
    // A corner of a tile is 0.01 beside the box.
    const Transform pose = Transform::translation({3.39, 3.5 + step / 20.0, -0.03});
    for (ProximityQuery* query : {&plain, &pair, &convex}) query->set_pose(0, pose);
    ASSERT_TRUE(pair.colliding());
    EXPECT_EQ(sideways(convex.separating_contacts()), 0);
    EXPECT_GE(convex.separating_contacts().size(), 4u);
    left_out += sideways(plain.separating_contacts());
    EXPECT_EQ(sideways(pair.separating_contacts()), 0);
    EXPECT_GE(pair.separating_contacts().size(), 4u);
    EXPECT_EQ(pair.separating_contacts().size() + sideways(plain.separating_contacts()),
              plain.separating_contacts().size());
  }
  EXPECT_GT(left_out, 0);
}

// Regression: the faces along the ridge of a rod have corners of a third of a degree at its ends, and were
// taken for flat there.
TEST(InternalEdges, KeepTheRidgeOfAThinRod) {
  Mesh rod;
  for (const double x : {0.0, 10.0})
    rod.positions.insert(rod.positions.end(), {{x, 0, 0}, {x, -0.05, -0.0044}, {x, 0.05, -0.0044}});
  rod.triangles = {{0, 1, 2}, {3, 5, 4}};
  for (const auto& [i, j] : {std::array{1u, 0u}, std::array{0u, 2u}, std::array{2u, 1u}})
    rod.triangles.insert(rod.triangles.end(), {{i, j, j + 3}, {i, j + 3, i + 3}});
  const Shape box(brick({4, -1e-4, -0.5}, {6, 1, 0.5})), shape(rod);  // its side pushes the ridge
  ASSERT_TRUE(shape.sites().closed() && shape.sites().orientable());
  ProximityQuery plain(box, shape), pair(box, shape, {.ignore_internal_edges = true});
  const auto on_ridge = [](std::span<const Contact> contacts) {
    return std::ranges::count_if(contacts, [](const Contact& c) {
      return std::abs(c.point2[1]) + std::abs(c.point2[2]) < 1e-9 && std::abs(c.normal[1]) > 0.99;
    });
  };
  ASSERT_GT(on_ridge(plain.contacts()), 0);
  EXPECT_EQ(on_ridge(pair.contacts()), on_ridge(plain.contacts()));
}

}  // namespace
}  // namespace sdm::test

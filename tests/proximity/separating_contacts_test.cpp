// Contacts that push bodies apart, by a solver that projects a translation on one contact after the other.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "bodies/separate/separating_contacts.h"
#include "scenes/blocks.h"
#include "support/allocations.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using scenes::union_of;

// The translation after one sweep over the contacts.
Vec3 projected_sweep(std::span<const Contact> contacts) {
  Vec3 t{};
  for (const Contact& c : contacts)
    if (const double rest = c.depth - dot(c.normal, t); rest > 0) t += rest * c.normal;
  return t;
}

Transform overlapping_pose(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> along(0, reach);
  const Vec3 direction = normalized(Vec3{normal(random), normal(random), normal(random)});
  return Transform::translation(along(random) * direction) *
         Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
}

void expect_contacts_of(ProximityQuery& query) {
  const std::span<const Contact> contacts = query.separating_contacts();
  ASSERT_FALSE(contacts.empty());
  const SeparatingTranslation& out = query.separating_translation();
  std::set<std::uint64_t> ids;
  for (const Contact& c : contacts) {
    EXPECT_NEAR(norm(c.normal), 1, 1e-9);
    for (int k = 0; k < 3; ++k) EXPECT_FALSE(c.normal[k] == 0 && std::signbit(c.normal[k])) << "prints as -0";
    EXPECT_NEAR(c.depth, std::min(dot(c.normal, c.point2 - c.point1), dot(c.normal, out.translation)), 1e-9);
    EXPECT_LE(c.depth, out.upper + 1e-9);
    EXPECT_LE(c.depth, dot(c.normal, out.translation) + 1e-9);
    ids.insert(c.id);
    for (int body = 0; body < 2; ++body) {
      const Mesh& mesh = query.sites(body).mesh();
      Vec3 p{};
      for (int k = 0; k < 3; ++k)
        p += c.on[body].barycentric[k] * mesh.positions[mesh.triangles[c.on[body].face][k]];
      EXPECT_LE(norm(query.pose(body)(p) - (body == 0 ? c.point1 : c.point2)), 1e-8);
    }
  }
  EXPECT_EQ(ids.size(), contacts.size());
}

TEST(SeparatingContacts, PushSpheresAndBoxesApart) {
  ProximityQuery spheres(sphere(3), sphere(3));
  spheres.set_pose(1, Transform::translation({0.6, 0, 0}));
  expect_contacts_of(spheres);
  EXPECT_LT(spheres.separating_contacts()[0].normal[0], -0.97);
  EXPECT_NEAR(projected_sweep(spheres.separating_contacts())[0], -1.4, 0.04);
  ProximityQuery boxes(cube(), cube());
  boxes.set_pose(1, Transform::translation({1.4, 0.3, 0.2}));
  expect_contacts_of(boxes);
  EXPECT_GE(boxes.separating_contacts().size(), 4u) << "the corners of the common part";
  for (const Contact& c : boxes.separating_contacts()) {
    EXPECT_NEAR(c.depth, 0.6, 1e-6);
    EXPECT_NEAR(c.normal[0], -1, 1e-6);
  }
}

// A body at rest moves by little, and all of its contacts are as deep.
TEST(SeparatingContacts, OfABodyAtRestKeepTheirOrder) {
  const Mesh floor = union_of({{{-5, -5, -2}, {5, 5, -0.99}}});
  const Mesh bodies[]{cube(), union_of({{{-1, -1, -1}, {1, 1, 1}}, {{-1, -1, 1}, {0.2, 0.2, 2}}})};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> little(-1e-7, 1e-7);
  for (const Mesh& body : bodies) {
    ProximityQuery query(body, floor);
    std::array<std::vector<std::uint64_t>, 2> first;
    for (int frame = 0; frame < 20; ++frame) {
      query.set_pose(0, Transform::translation({little(random), little(random), little(random)}) *
                            Transform::rotation({little(random), little(random), little(random)}));
      for (const int separating : {0, 1}) {
        std::vector<std::uint64_t> ids;
        for (const Contact& c : separating == 1 ? query.separating_contacts() : query.contacts())
          ids.push_back(c.id);
        if (frame == 0) first[separating] = ids;
        EXPECT_EQ(ids, first[separating]) << frame;
      }
    }
    EXPECT_GE(first[0].size(), 4u);
  }
}

TEST(SeparatingContacts, OfBodiesInOnePlaceHaveOneDirection) {
  for (const Mesh& mesh : {cube(), sphere(2), ring(12)}) {
    ProximityQuery query(mesh, mesh);
    expect_contacts_of(query);
    const Vec3 step = projected_sweep(query.separating_contacts());
    EXPECT_GT(norm(step), 0.3);
    EXPECT_EQ(projected_sweep(ProximityQuery(mesh, mesh).separating_contacts()), step);
  }
}

TEST(SeparatingContacts, PushABallOutOfAPlateOnTheNearerSide) {
  Mesh plate = cube();
  for (Vec3& p : plate.positions) p = {3 * p[0], 3 * p[1], 0.02 * p[2]};
  for (const double height : {0.05, -0.05, 0.2, -0.2}) {
    ProximityQuery query(placed(sphere(3), "scale:0.3"), plate);
    query.set_pose(0, Transform::translation({0.1, 0.2, height}));
    expect_contacts_of(query);
    const Vec3 step = projected_sweep(query.separating_contacts());
    EXPECT_GT(step[2] * height, 0);
    EXPECT_NEAR(std::abs(step[2]), 0.32 - std::abs(height), 5e-3);
  }
}

TEST(SeparatingContacts, KeepAFewOfAPatch) {
  ProximityQuery query(sphere(3), cube());
  query.set_pose(0, Transform::scaling(0.4));
  ProximityQuery boxes(cube(), cube(0.7));
  boxes.set_pose(1, Transform::translation({1.4, 0.3, 0.2}));
  for (ProximityQuery* q : {&query, &boxes}) {
    const std::span<const Contact> found = q->separating_contacts();
    const std::vector<Contact> all(found.begin(), found.end());
    for (const std::size_t most : {1u, 2u, 4u}) {
      const std::span<const Contact> few = q->separating_contacts(most);
      std::vector<std::size_t> of_patch(all.back().patch + 1);
      for (const Contact& c : few) {
        EXPECT_LE(++of_patch[c.patch], most);
        EXPECT_TRUE(std::ranges::any_of(all, [&](const Contact& a) { return a.id == c.id; }));
      }
      for (const std::size_t count : of_patch) EXPECT_GE(count, 1u);
      EXPECT_EQ(few[0].id, all[0].id) << "the deepest";
    }
  }
  EXPECT_THROW((void)query.separating_contacts(0), Error);
}

// Boxes that overlap in [0.4, 1] × [−0.7, 1] × [−0.8, 1] leave each other along x.
TEST(SeparatingContacts, KeepTheCornersOfAFaceOfABox) {
  ProximityQuery boxes(cube(), cube());
  boxes.set_pose(1, Transform::translation({1.4, 0.3, 0.2}));
  std::set<std::array<double, 2>> corners;
  for (const Contact& c : boxes.separating_contacts(4))
    if (c.id != ProximityQuery::kExitContact)
      corners.insert({std::round(1e6 * c.point2[1]) / 1e6, std::round(1e6 * c.point2[2]) / 1e6});
  EXPECT_EQ(corners, (std::set<std::array<double, 2>>{{-0.7, -0.8}, {-0.7, 1}, {1, -0.8}, {1, 1}}));
}

TEST(SeparatingContacts, KeepTheNextDeepestOfAPoint) {
  std::vector<Contact> contacts(4);
  for (std::size_t i = 0; i < 4; ++i) contacts[i].depth = 4.0 - static_cast<double>(i);
  contacts[3].point2 = {1, 0, 0};
  separate::SeparatingContacts kept(0);
  kept.assign(contacts);
  kept.keep_per_patch(3);
  ASSERT_EQ(kept.contacts().size(), 3u);
  EXPECT_EQ(kept.contacts()[0].depth, 4);
  EXPECT_EQ(kept.contacts()[1].depth, 3) << "at the point of the deepest";
  EXPECT_EQ(kept.contacts()[2].depth, 1) << "at another point";
}

// A block leaves the thick one of two walls towards the thin one, which is then closer.
TEST(SeparatingContacts, AreNoDeeperThanTheWayOutAtAFartherWall) {
  const auto slab = [](double from, double to) {
    Mesh mesh = cube();
    for (Vec3& p : mesh.positions) p[0] = p[0] < 0 ? from : to;
    return mesh;
  };
  const shape::PosedBody block{Shape(slab(-0.01, 0.37))}, walls{Shape(joined(slab(-1, 0), slab(0.388, 0.4)))};
  SeparatingTranslation out;
  out.translation = {0.015, 0, 0};
  out.value = out.upper = 0.015;
  separate::SeparatingContacts contacts(0);
  contacts.find(block, walls, out, {});
  const auto exit = std::ranges::find(contacts.contacts(), ProximityQuery::kExitContact, &Contact::id);
  ASSERT_NE(exit, contacts.contacts().end());
  EXPECT_NEAR(dot(exit->normal, exit->point2 - exit->point1), 0.018, 1e-12);
  EXPECT_DOUBLE_EQ(exit->depth, 0.015);
}

TEST(SeparatingContacts, AreThoseOfContactsIfBodiesAreApart) {
  ProximityQuery query(cube(), cube(), {.contact_margin = 0.1});
  query.set_pose(1, Transform::translation({0.2, 0.1, 2.05}));
  ASSERT_EQ(query.separating_contacts().size(), query.contacts().size());
  for (std::size_t i = 0; i < query.contacts().size(); ++i)
    EXPECT_EQ(query.separating_contacts()[i].depth, query.contacts()[i].depth);
}

// One sweep leaves a translation that is no longer than before, and twenty of them separate the bodies.
void expect_solved(const std::vector<std::array<Shape, 2>>& pairs, int poses, double reach) {
  std::mt19937 random(38);
  int worse = 0, stuck = 0, overlaps = 0;
  for (int i = 0; i < poses; ++i) {
    const auto& [a, b] = pairs[i % pairs.size()];
    ProximityQuery query(a, b);
    query.set_pose(0, overlapping_pose(random, reach));
    if (!query.colliding()) continue;
    ++overlaps;
    expect_contacts_of(query);
    const double first = query.separating_translation().upper;
    for (int step = 0; step < 20 && query.colliding(); ++step) {
      const Vec3 by = projected_sweep(query.separating_contacts());
      // A solver leaves no contact exactly at its end.
      query.set_pose(0, Transform::translation((1 + 1e-6) * by + 1e-9 * normalized(by)) * query.pose(0));
      if (step == 0 && query.separating_translation().upper > (1 + 1e-6) * first) ++worse;
    }
    if (query.colliding()) ++stuck;
  }
  EXPECT_GT(overlaps, poses / 2);
  EXPECT_LE(worse, overlaps / 100);
  EXPECT_LE(stuck, overlaps / 100);
}

TEST(SeparatingContacts, SeparateConvexBodiesInTwentySteps) {
  std::vector<std::array<Shape, 2>> pairs;
  const std::array meshes{cube(), sphere(1), tetrahedron()};
  for (const Mesh& a : meshes)
    for (const Mesh& b : meshes) pairs.push_back({Shape(a), Shape(b)});
  expect_solved(pairs, 900, 1.5);
}

TEST(SeparatingContacts, SeparateOtherBodiesInTwentySteps) {
  std::vector<std::array<Shape, 2>> pairs;
  const std::array meshes{ring(10), load("pig.off", "fit"), placed(ring(8), "scale:0.3")};
  for (const Mesh& a : meshes) pairs.push_back({Shape(a), Shape(cube(0.5))});
  pairs.push_back({Shape(meshes[0]), Shape(meshes[2])});
  pairs.push_back({Shape(meshes[1]), Shape(meshes[1])});
  expect_solved(pairs, 150, 1);
}

TEST(SeparatingContacts, SeparateOpenSurfacesAndToriInTwentySteps) {
  Mesh open = cube(0.5);
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);
  const std::array meshes{open, placed(torus(16, 8), "scale:0.3")};
  std::vector<std::array<Shape, 2>> pairs;
  for (const Mesh& a : meshes)
    for (const Mesh& b : meshes) pairs.push_back({Shape(a), Shape(b)});
  expect_solved(pairs, 120, 0.7);
}

TEST(SeparatingContacts, OfNonConvexBodiesAllocateNothingAfterTheFirstPoses) {
  const ThreadLimit alone(1);  // threads that join later allocate memory of their own
  const Mesh open = height_field(6);
  const std::array pairs{std::array{ring(10), load("pig.off", "fit")}, std::array{ring(8), ring(10)},
                         std::array{ring(8), open}};
  for (const auto& [first, second] : pairs) {
    ProximityQuery query(first, second, {.ignore_internal_edges = true});
    std::size_t colliding = 0;
    const auto taken = [&] {
      const std::size_t before = allocations();
      for (int i = 0; i < 8; ++i) {
        query.set_pose(1, Transform::translation({0.3 - 0.02 * i, 0.1 * i, 0.03 * i}) *
                              Transform::rotation({10.0 * i, 20.0 * i, 30}));
        colliding += query.colliding() ? 1 : 0;
        (void)query.separating_contacts(2);
      }
      return allocations() - before;
    };
    EXPECT_GT(taken(), 0u);
    EXPECT_EQ(taken(), 0u);
    EXPECT_GE(colliding, 8u);
  }
}

}  // namespace
}  // namespace sdm::test

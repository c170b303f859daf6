// Proximity of two bodies and of a mesh to itself: one small case for each query, against all pairs of faces
// or a closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <new>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "geometry/triangle_pair.h"
#include "smoke/small_meshes.h"
#include "support/oracle.h"
#include "support/pair_oracle.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

Corners corners_of(const Mesh& mesh, const Triangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

double least_distance_of_faces(const Mesh& a, const Mesh& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& s : a.triangles)
    for (const Triangle& t : b.triangles) {
      const Corners first = corners_of(a, s), second = corners_of(b, t);
      if (squared_box_distance(first, second) > least * least) continue;  // exact arithmetic takes long
      least = std::min(least, oracle::distance(first, second));
    }
  return least;
}

Mesh posed(Mesh mesh, const Transform& pose) {
  transform(mesh, pose);
  return mesh;
}

Transform random_pose(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(-reach, reach);
  return Transform::translation({place(random), place(random), place(random)}) *
         Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
}

TEST(SmokePairs, SeparationsAgreeWithAllPairsOfFaces) {
  std::mt19937 random(4);
  std::vector<Mesh> meshes{single_triangle(), square(1, 0), tetrahedron(), cube(0.5),
                           taken_apart(cube(0.4), 0)};
  for (const std::size_t count : {3, 5, 7, 9, 15, 17}) meshes.push_back(first_faces(sphere(1), count));
  int collisions = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const Mesh &a = meshes[i], &b = meshes[(2 * i + 1) % meshes.size()];
    ProximityQuery query(a, b);
    for (const double reach : {0.4, 2.0}) {
      const Transform pose = random_pose(random, reach);
      query.set_pose(1, pose);
      const Mesh there = posed(b, query.pose(1));
      const double expected = least_distance_of_faces(a, there);
      const BoundedLength& found = query.separation();
      EXPECT_NEAR(found.value, expected, 1e-9);
      EXPECT_EQ(found.certainty, Certainty::exact);
      EXPECT_NEAR(norm((*found.witness)[0] - (*found.witness)[1]), found.value, 1e-9);
      EXPECT_NEAR(oracle::brute_force(there, (*found.witness)[1]), 0, 1e-9);
      if (expected == 0) {
        EXPECT_TRUE(query.colliding());
      }
      collisions += query.colliding();
      if (!query.colliding()) {
        EXPECT_THAT(query.contacts(), ::testing::IsEmpty());
      }
    }
  }
  EXPECT_GT(collisions, 1);
  EXPECT_LT(collisions, 20);
}

// Trees of several levels, far from the origin, and shapes of another size.
TEST(SmokePairs, SeparationsOfDeepTreesAgreeWithClosestVerticesAndFaces) {
  const Mesh a = moved(torus(24, 17), {1e4, 0, 0}), b = sphere(3);
  ProximityQuery query(a, b);
  query.set_pose(1, Transform::translation({1e4 + 0.1, 0.05, 0.02}) * Transform::scaling(0.5));
  EXPECT_NEAR(query.separation().value, 0.5, 0.12) << "a ball of radius 0.5 in a hole of radius 1";
  EXPECT_FALSE(query.colliding());
  query.set_pose(1, Transform::translation({1e4 + 2, 0.05, 0.02}) * Transform::scaling(0.5));
  EXPECT_TRUE(query.colliding()) << "inside of the tube";
  EXPECT_NEAR(query.separation().value, 0.5, 0.12);
  EXPECT_NEAR(query.penetration_depth()->value, 1.0, 0.25);
  query.set_pose(1, Transform::translation({1e4 + 3.2, 0.05, 0.02}) * Transform::scaling(0.5));
  EXPECT_EQ(query.separation().value, 0);
  EXPECT_TRUE(query.colliding());
  EXPECT_NEAR(query.penetration_depth()->value, 0.3, 0.06);
}

// Cubes that overlap by 0.2 along x.
TEST(SmokePairs, DepthAndTheWayOutOfConvexSolids) {
  for (const bool convex : {true, false}) {
    const Mesh box = convex ? cube() : joined(cube(), cube(0.2));  // a solid inside hides no way out
    ProximityQuery query(box, cube());
    EXPECT_EQ(Shape(box).convex(), convex);
    query.set_pose(1, Transform::translation({1.8, 0.1, 0.3}));
    EXPECT_TRUE(query.colliding());
    const BoundedLength depth = *query.penetration_depth();
    EXPECT_LE(depth.lower, 0.2 + 1e-9);
    EXPECT_GE(depth.upper, 0.2 - 1e-9);
    EXPECT_LT(depth.upper - depth.lower, 0.01);
    const SeparatingTranslation way = query.separating_translation();
    EXPECT_NEAR(way.upper, 0.2, 1e-5);
    EXPECT_LE(way.lower, 0.2 + 1e-9);
    EXPECT_LT(norm(way.translation + Vec3{0.2, 0, 0}), 1e-4);
    std::size_t count = 0;
    for (const Contact& c : query.separating_contacts()) {
      EXPECT_LT(norm(c.normal + Vec3{1, 0, 0}), 1e-6);
      EXPECT_NEAR(c.depth, 0.2, 1e-4);
      EXPECT_NEAR(dot(c.normal, c.point2 - c.point1), c.depth, 1e-9);
      ++count;
    }
    EXPECT_GE(count, 4u);
    EXPECT_LE(query.separating_contacts(3).size(), convex ? 1 + 3 : count)
        << "the exit is a patch of its own";
    query.set_pose(0, Transform::translation(1.0001 * way.translation));
    EXPECT_FALSE(query.colliding());
    EXPECT_EQ(query.separating_translation().upper, 0);
    EXPECT_EQ(query.penetration_depth()->value, 0);
  }
}

TEST(SmokePairs, TheWayOutOfBodiesThatAreNotConvexIsVerified) {
  std::mt19937 random(9);
  const Mesh a = torus(12, 9), b = joined(sphere(1), moved(cube(0.4), {0.9, 0, 0}));
  ProximityQuery query(a, b, {.depth_precision = 0.01});
  for (int i = 0; i < 2; ++i) {
    query.set_pose(0, {});
    query.set_pose(1, random_pose(random, 1.2));
    if (!query.colliding()) continue;
    const SeparatingTranslation way = query.separating_translation();
    EXPECT_LE(query.penetration_depth()->lower, way.upper + 1e-9);
    EXPECT_LE(way.lower, way.upper);
    EXPECT_NEAR(norm(way.translation), way.upper, 1e-9);
    for (const Contact& c : query.separating_contacts())
      EXPECT_LE(c.depth, dot(c.normal, way.translation) + 1e-9);
    query.set_pose(0, Transform::translation(way.translation));
    EXPECT_FALSE(query.colliding());
  }
}

TEST(SmokePairs, ABoxOnAPlateHasContactsAtItsCorners) {
  const Mesh box = test::box({-0.5, -0.4, 0}, {0.5, 0.4, 0.6});
  for (const Mesh& plate : {test::box({-3, -3, -1}, {3, 3, 0}),
                            weld(grid_block({-3, -3, -1}, {3, 3, 0}, 7)).mesh, grid_square(6, 0, 9)}) {
    ProximityQuery query(box, plate, {.contact_margin = 0.02});
    for (const double height : {-0.01, 0.01}) {
      query.set_pose(0, Transform::translation({0.13, 0.22, height}));
      std::set<std::uint64_t> ids;
      std::set<std::pair<int, int>> corners;
      for (const Contact& c : query.contacts()) {
        EXPECT_NEAR(std::abs(c.normal[2]), 1, 1e-9);
        EXPECT_NEAR(std::abs(c.depth), 0.01, 1e-9);
        EXPECT_LT(norm(c.point2 - c.point1 - c.depth * c.normal), 1e-9);
        EXPECT_NE(c.on[0].face, kNone);
        ids.insert(c.id);
        const double x = std::abs(c.point1[0] - 0.13), y = std::abs(c.point1[1] - 0.22);
        if (std::abs(x - 0.5) < 1e-6 && std::abs(y - 0.4) < 1e-6)
          corners.insert({c.point1[0] > 0.13, c.point1[1] > 0.22});
      }
      EXPECT_EQ(ids.size(), query.contacts().size());
      EXPECT_EQ(corners.size(), 4u);
      EXPECT_EQ(query.contacts().back().patch, 0u);
    }
  }
}

// Two bodies that touch in two places have two patches; beams that cross have contacts where edges cross.
TEST(SmokePairs, ContactsArePatchesOfConnectedParts) {
  const Mesh posts = joined(box({-1, -0.1, -1}, {-0.8, 0.1, 0}), box({0.8, -0.1, -1}, {1, 0.1, 0}));
  ProximityQuery plank(weld(grid_block({-1.5, -0.05, 0}, {1.5, 0.05, 0.1}, 15)).mesh, posts,
                       {.contact_margin = 0.001});
  plank.set_pose(0, Transform::translation({0, 0, -0.0005}));
  std::set<std::uint32_t> patches;
  for (const Contact& c : plank.contacts()) patches.insert(c.patch);
  EXPECT_EQ(patches.size(), 2u);

  ProximityQuery beams(box({-2, -0.1, 0}, {2, 0.1, 0.2}), box({-0.1, -2, -0.2}, {0.1, 2, 0}));
  beams.set_pose(0, Transform::translation({0, 0, -0.01}));
  ASSERT_GE(beams.contacts().size(), 4u);
  for (const Contact& c : beams.contacts()) {
    EXPECT_LE(std::abs(c.point1[0]), 0.1 + 1e-6);
    EXPECT_LE(std::abs(c.point1[1]), 0.1 + 1e-6);
    EXPECT_NEAR(c.depth, 0.01, 1e-9);
  }
}

// Fine and smooth bodies: no contact is deeper than the bodies, and there is one about as deep.
TEST(SmokePairs, ContactsOfSmoothBodiesAreNoDeeperThanTheBodies) {
  ProximityQuery query(sphere(3),
                       mapped_by(sphere(2),
                                 [](const Vec3& p) {
                                   return Vec3{p[0], 0.5 * p[1], 0.5 * p[2]};
                                 }),
                       {.contact_margin = 0.01});
  for (const Vec3& at : {Vec3{1.8, 0.2, 0}, Vec3{0.2, 1.2, 0.1}, Vec3{0.1, 0, 0.05}}) {
    query.set_pose(1, Transform::translation(at) * Transform::rotation({20, 30, 0}));
    ASSERT_FALSE(query.contacts().empty());
    const double deepest = query.contacts().front().depth;
    EXPECT_LE(deepest, query.penetration_depth()->upper + 1e-9);
    EXPECT_GE(deepest, 0.5 * query.penetration_depth()->lower);
    EXPECT_GE(query.separating_translation().upper, deepest - 1e-6);
    EXPECT_FALSE(query.separating_contacts(4).empty());
  }
}

TEST(SmokePairs, ABoxIsNotCaughtByTheTrianglesThatItSlidesOver) {
  const Mesh box = test::box({-0.6, -0.6, 0}, {0.6, 0.6, 0.6}), floor = grid_square(8, 0, 8);
  ProximityQuery query(box, floor, {.contact_margin = 0.02, .ignore_internal_edges = true});
  for (int step = 0; step < 5; ++step) {
    query.set_pose(0,
                   Transform::translation({0.17 * step - 0.3, 0.1, -0.05}) * Transform::rotation({0, 0, 17}));
    EXPECT_GE(query.contacts().size(), 4u);
    for (const Contact& c : query.contacts()) EXPECT_GT(std::abs(c.normal[2]), 0.99);
    EXPECT_FALSE(query.separating_contacts().empty());
  }
}

TEST(SmokePairs, OpenSurfacesHaveNoDepth) {
  ProximityQuery query(first_faces(sphere(1), 17), square(4, 0.7));
  EXPECT_FALSE(query.penetration_depth());
  EXPECT_TRUE(query.colliding());
  EXPECT_EQ(query.separating_translation().lower, 0);
  EXPECT_GT(query.separating_translation().upper, 0);
  EXPECT_FALSE(query.sites(0).closed());
  EXPECT_THROW((void)query.surface(0), Error);
}

// A solid that intersects itself: the inside is that of its winding numbers.
TEST(SmokePairs, DepthInASolidThatIntersectsItself) {
  const Mesh crossing = joined(cube(), moved(cube(), {0.9, 0.2, 0.1}));
  ProximityQuery query(sphere(1), crossing);
  query.set_pose(0, Transform::translation({0.45, 0.1, 0.05}) * Transform::scaling(0.3));
  // The most that a point of the ball is away from the boundary of the union.
  double deepest = 0;
  for (const Vec3& p : sphere(1).positions) {
    const Vec3 q = query.pose(0)(p);
    // Both boxes hold the ball; the depth is at least the larger one of both.
    const auto depth_in = [&](const Vec3& centre) {
      double least = 1;
      for (std::size_t k = 0; k < 3; ++k) least = std::min(least, 1 - std::abs(q[k] - centre[k]));
      return least;
    };
    deepest = std::max({deepest, depth_in({0, 0, 0}), depth_in({0.9, 0.2, 0.1})});
  }
  EXPECT_GE(query.penetration_depth()->upper, deepest - 1e-9);
  EXPECT_LT(query.penetration_depth()->upper, deepest + 0.25);
  EXPECT_GT(query.contacts().size(), 0u);
  EXPECT_FALSE(is_embedded(query.sites(1)));
}

TEST(SmokePairs, FollowDeformationEditsAndReplacement) {
  const Mesh first = sphere(1), other = torus(9, 7);
  ProximityQuery query(first, other, {.contact_margin = 0.1});
  query.set_pose(0, Transform::translation({0.2, 0.1, 1.7}));
  const Mesh wide = mapped_by(first, [](const Vec3& p) { return Vec3{1.4 * p[0], 1.4 * p[1], p[2]}; });
  query.refit(wide.positions, {});
  ProximityQuery expected(wide, other, {.contact_margin = 0.1});
  expected.set_pose(0, query.pose(0));
  EXPECT_EQ(query.separation().value, expected.separation().value);
  EXPECT_EQ(query.contacts().size(), expected.contacts().size());

  const MeshEdit edit{.removed_faces = {1, 2}, .moved_vertices = {{.vertex = 3, .position = {0, -2, 0.3}}}};
  query.edit(0, edit);
  Mesh edited = wide;
  apply(edited, edit);
  ProximityQuery of_edited(edited, other, {.contact_margin = 0.1});
  of_edited.set_pose(0, query.pose(0));
  EXPECT_EQ(query.separation().value, of_edited.separation().value);
  EXPECT_EQ(query.colliding(), of_edited.colliding());
  EXPECT_EQ(query.contacts().size(), of_edited.contacts().size());

  query.replace(1, Shape(cube(), {.resolution = 32}));
  EXPECT_NEAR(query.separation().value, least_distance_of_faces(posed(edited, query.pose(0)), cube()), 1e-9);
  EXPECT_EQ(query.surface(1).resolution(), 32u);
}

TEST(SmokePairs, StoredShapesGiveTheSameAnswers) {
  const TemporaryFolder folder;
  for (const Mesh& mesh :
       {sphere(2), first_faces(torus(7, 5), 61), degenerate_soup(33, 4), single_triangle()}) {
    const Shape built(mesh, {.resolution = 48});
    std::vector<std::byte> bytes;
    built.store(
        [&](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); });
    constexpr std::align_val_t kAlignment{64};
    auto* const data = static_cast<std::byte*>(::operator new(bytes.size(), kAlignment));
    std::ranges::copy(bytes, data);
    const Shape taken(StoredShape{{data, bytes.size()}, std::shared_ptr<void>(data, [](void* memory) {
                                    ::operator delete(memory, kAlignment);
                                  })});
    write_shape(folder / "shape", built);
    const Shape read = read_shape(folder / "shape");
    const Shape ball(sphere(1));
    ProximityQuery expected(built, ball, {.contact_margin = 0.05});
    for (const Shape& stored : {taken, read}) {
      EXPECT_EQ(stored.convex(), built.convex());
      EXPECT_TRUE(stored.has_surface());
      EXPECT_TRUE(std::ranges::equal(stored.surface().texel_faces(), built.surface().texel_faces()));
      ProximityQuery query(stored, ball, {.contact_margin = 0.05});
      for (const Vec3& at : {Vec3{0.3, 1.2, 0.1}, Vec3{3, 0, 1}}) {
        expected.set_pose(1, Transform::translation(at));
        query.set_pose(1, Transform::translation(at));
        EXPECT_EQ(query.separation().value, expected.separation().value);
        EXPECT_EQ(query.colliding(), expected.colliding());
        EXPECT_EQ(query.penetration_depth()->upper, expected.penetration_depth()->upper);
        EXPECT_EQ(query.contacts().size(), expected.contacts().size());
      }
    }
    bytes[bytes.size() / 2] ^= std::byte{1};
    std::ranges::copy(bytes, data);
    EXPECT_THROW((void)Shape(StoredShape{{data, bytes.size()}, nullptr}), Error);
  }
}

TEST(SmokeMotion, CubesMeetWhenTheirFacesDo) {
  const Shape box(cube(0.5)), ball(sphere(2));
  const Motion rest{},
      flight{.from = Transform::translation({5, 0.1, 0.2}), .to = Transform::translation({-5, 0.1, 0.2})};
  const TimeOfContact found = time_of_contact(box, rest, box, flight, 1e-6);
  EXPECT_TRUE(found.contact);
  EXPECT_NEAR(found.time, 0.4, 1e-6);
  EXPECT_LT(norm(*found.normal - Vec3{-1, 0, 0}), 1e-6);
  EXPECT_LE(found.separation, 1e-6);
  EXPECT_EQ(flight.at(0.5, box)(Vec3{}), (Vec3{0, 0.1, 0.2}));
  // Not met, in spite of turns; a rod that turns into a box; bodies that collide at first.
  const Motion above{.from = Transform::translation({5, 0, 2}),
                     .to = Transform::translation({-5, 0, 2}) * Transform::rotation({120, 40, 10})};
  EXPECT_FALSE(time_of_contact(box, rest, box, above, 1e-6).contact);
  const Shape rod(test::box({-3, -0.05, -0.05}, {3, 0.05, 0.05}));
  const Motion turn{.from = Transform::translation({0, 2, 0}),
                    .to = Transform::translation({0, 2, 0}) * Transform::rotation({0, 0, 90})};
  const TimeOfContact turned = time_of_contact(rod, turn, box, rest, 1e-5);
  ASSERT_TRUE(turned.contact);
  ProximityQuery before(rod, box);
  before.set_pose(0, turn.at(turned.time - 0.01, rod));
  EXPECT_FALSE(before.colliding());
  before.set_pose(0, turn.at(turned.time + 0.01, rod));
  EXPECT_TRUE(before.colliding());
  EXPECT_EQ(time_of_contact(box, rest, ball, rest, 1e-6).time, 0);
}

TEST(SmokeMotion, NothingIsMissedByFineMeshesThatTurn) {
  const Shape wheel(torus(16, 7)), other(sphere(1)), soup_like(degenerate_soup(33, 4));
  std::mt19937 random(12);
  int met = 0;
  for (int i = 0; i < 4; ++i) {
    const Motion first{.from = random_pose(random, 4), .to = random_pose(random, 4)},
        second{.from = random_pose(random, 3), .to = random_pose(random, 3)};
    const TimeOfContact found = time_of_contact(wheel, first, i == 3 ? soup_like : other, second, 1e-4);
    met += found.contact;
    ProximityQuery query(wheel, i == 3 ? soup_like : other);
    for (int step = 0; step < 20; ++step) {
      const double time = step * found.time / 20;
      query.set_pose(0, first.at(time, wheel));
      query.set_pose(1, second.at(time, i == 3 ? soup_like : other));
      if (time < found.time) {
        EXPECT_FALSE(query.colliding());
      }
    }
  }
  EXPECT_GT(met, 0);
}

TEST(SmokeSelf, SquaresThatFaceEachOtherAreTheirDistanceApart) {
  const Mesh mesh = joined(grid_square(1, 0, 3), grid_square(1, 0.3, 3));
  SelfProximityQuery query(mesh, {.exclusion = {.rings = 5}});
  EXPECT_NEAR(query.separation()->value, 0.3, 1e-12);
  EXPECT_EQ(query.exclusion().faces(), 36u);
  EXPECT_THAT(query.contacts(0.2), ::testing::IsEmpty());
  const std::span<const Contact> contacts = query.contacts(0.31);
  ASSERT_GE(contacts.size(), 18u);
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.depth, -0.3, 1e-12);
    EXPECT_EQ(c.patch, 0u);
  }
  std::vector<Vec3> bent = mesh.positions;
  for (Vec3& p : bent)
    if (p[2] > 0) p[2] += 0.2 * p[0] - 0.15;
  query.refit(bent);
  double least = 1;
  for (std::size_t f = 0; f < 18; ++f)
    for (std::size_t g = 18; g < 36; ++g) {
      const Mesh& now = query.sites().mesh();
      least = std::min(
          least, oracle::distance(corners_of(now, now.triangles[f]), corners_of(now, now.triangles[g])));
    }
  EXPECT_NEAR(query.separation()->value, least, 1e-9);
  SelfProximityQuery folded(spiral_ramp(2, 30), {.exclusion = {.geodesic = 0.5}, .max_distance = 1});
  EXPECT_NEAR(folded.separation()->value, 0.02 * 2 * std::acos(-1.0), 0.01) << "a turn above";
  EXPECT_GT(folded.contacts(0.2).size(), 10u);
}

}  // namespace
}  // namespace sdm::test

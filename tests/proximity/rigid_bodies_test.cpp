// Bodies in poses against the same bodies with moved vertices, and against themselves in other frames.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "geometry/vec.h"
#include "support/allocations.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

const AtlasOptions kAtlas{.resolution = 64};

/// A rotation, a scale unless 1, and an offset of at most `reach` along each axis.
Transform random_pose(std::mt19937& random, double reach, bool scaled) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-reach, reach), scale(0.5, 2);
  const Transform rotation =
      Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
  return Transform::translation({offset(random), offset(random), offset(random)}) *
         Transform::scaling(scaled ? scale(random) : 1) * rotation;
}

std::vector<Vec3> in_pose(const Mesh& mesh, const Transform& pose) {
  std::vector<Vec3> positions = mesh.positions;
  transform(positions, pose);
  return positions;
}

Vec3 point_at(const std::vector<Vec3>& positions, const Mesh& mesh, std::uint32_t face, const Vec3& weights) {
  const auto& [a, b, c] = mesh.triangles[face];
  return weights[0] * positions[a] + weights[1] * positions[b] + weights[2] * positions[c];
}

void expect_equal(const BoundedLength& a, const BoundedLength& b) {
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_EQ(a.certainty, b.certainty);
  EXPECT_EQ(a.witness, b.witness);
}

void expect_equal(const Contact& a, const Contact& b) {
  EXPECT_EQ(a.point1, b.point1);
  EXPECT_EQ(a.point2, b.point2);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.patch, b.patch);
  EXPECT_EQ(a.on, b.on);
  EXPECT_EQ(a.id, b.id);
}

void expect_equal(ProximityQuery& a, ProximityQuery& b) {
  expect_equal(a.separation(), b.separation());
  EXPECT_EQ(a.colliding(), b.colliding());
  ASSERT_EQ(a.penetration_depth().has_value(), b.penetration_depth().has_value());
  if (a.penetration_depth()) expect_equal(*a.penetration_depth(), *b.penetration_depth());
  ASSERT_EQ(a.contacts().size(), b.contacts().size());
  for (std::size_t i = 0; i < a.contacts().size(); ++i) expect_equal(a.contacts()[i], b.contacts()[i]);
}

/// Overlapping shells, a concave body and an open sheet.
std::vector<Mesh> various() {
  Mesh two = joined(cube(0.3), moved(cube(0.25), {0.2, 0.1, 0.05}));
  Mesh sheet = band(20, false);
  for (Vec3& p : sheet.positions) p = 0.4 * p;
  return {load("cow.off", "fit"), placed(torus(24, 12), "fit"), two, sheet};
}

// The atlas of a body that deforms is that of its first shape, as with poses.
// A third body was read from beyond the array of two.
TEST(RigidBodies, ThereAreTwo) {
  ProximityQuery query(test::cube(1), test::cube(1));
  for (const int body : {-1, 2}) {
    EXPECT_THROW(query.set_pose(body, {}), Error);
    EXPECT_THROW((void)query.pose(body), Error);
    EXPECT_THROW((void)query.sites(body), Error);
    EXPECT_THROW(query.replace(body, Shape(test::cube(1))), Error);
    EXPECT_THROW(query.edit(body, {}), Error);
  }
}

TEST(RigidBodies, AgreeWithMovedVertices) {
  const std::vector<Mesh> meshes = various();
  std::mt19937 random(3);
  int colliding = 0, apart = 0;
  for (std::size_t a = 0; a < meshes.size(); ++a)
    for (std::size_t b = 0; b < meshes.size(); ++b) {
      SCOPED_TRACE(std::to_string(a) + ' ' + std::to_string(b));
      const ProximityOptions options{.contact_margin = 0.05};
      ProximityQuery posed(meshes[a], meshes[b], options), moved(meshes[a], meshes[b], options);
      for (int i = 0; i < 6; ++i) {
        const std::array poses{random_pose(random, 0.4, i % 2 == 1), random_pose(random, 0.4, i % 3 == 1)};
        const std::array vertices{in_pose(meshes[a], poses[0]), in_pose(meshes[b], poses[1])};
        for (int body = 0; body < 2; ++body) posed.set_pose(body, poses[body]);
        moved.refit(vertices[0], vertices[1]);
        const double tolerance = 1e-5;  // bodies of size 0.5 to 2
        EXPECT_NEAR(posed.separation().value, moved.separation().value, 1e-12);
        ASSERT_TRUE(posed.separation().witness);
        EXPECT_NEAR(norm((*posed.separation().witness)[1] - (*posed.separation().witness)[0]),
                    posed.separation().value, 1e-12);
        ASSERT_EQ(posed.colliding(), moved.colliding());
        ++(posed.colliding() ? colliding : apart);
        ASSERT_EQ(posed.penetration_depth().has_value(), moved.penetration_depth().has_value());
        if (posed.penetration_depth()) {
          const BoundedLength &p = *posed.penetration_depth(), &m = *moved.penetration_depth();
          EXPECT_LE(p.lower, m.upper + tolerance);
          EXPECT_LE(m.lower, p.upper + tolerance);
          if (a != 2 && b != 2) {  // the solid that intersects itself has bounds of its own
            EXPECT_NEAR(p.value, m.value, 5e-3);
          }
        }
        std::map<std::uint64_t, Contact> contacts;
        for (const Contact& c : posed.contacts()) EXPECT_TRUE(contacts.emplace(c.id, c).second);
        const double part = std::max(diagonal(bounds(meshes[a])), diagonal(bounds(meshes[b]))) / 16;
        std::size_t shallow = 0, same = 0;
        for (const Contact& c : moved.contacts()) {
          if (c.depth > part / 4) continue;
          ++shallow;
          const auto found = contacts.find(c.id);
          same += found != contacts.end() && std::abs(found->second.depth - c.depth) < 100 * tolerance;
        }
        // A sample at the margin, or one of two that are equally deep, may be chosen in one query only.
        EXPECT_GE(same + 1, 0.95 * static_cast<double>(shallow));
        // Deeper ones are of regions that depend on the tree: each is near one that is as deep.
        const auto is_covered = [&](const Contact& c, std::span<const Contact> by) {
          return std::ranges::any_of(by, [&](const Contact& other) {
            const bool on_b = c.id >> 63 != 0;
            return other.id >> 63 == c.id >> 63 && other.depth >= c.depth - 100 * tolerance &&
                   norm(on_b ? other.point2 - c.point2 : other.point1 - c.point1) <=
                       std::max(part, other.depth) + tolerance;
          });
        };
        for (const auto& [some, others] :
             {std::pair(posed.contacts(), moved.contacts()), std::pair(moved.contacts(), posed.contacts())}) {
          const auto covered =
              std::ranges::count_if(some, [&](const Contact& c) { return is_covered(c, others); });
          EXPECT_GE(covered + 1, 0.98 * static_cast<double>(some.size()));
        }
        for (const Contact& c : posed.contacts()) {
          EXPECT_NEAR(norm(point_at(vertices[0], meshes[a], c.on[0].face, c.on[0].barycentric) - c.point1), 0,
                      tolerance);
          EXPECT_NEAR(norm(point_at(vertices[1], meshes[b], c.on[1].face, c.on[1].barycentric) - c.point2), 0,
                      tolerance);
          EXPECT_NEAR(norm(c.point2 - c.point1), std::abs(c.depth), tolerance);
          EXPECT_NEAR(norm(c.normal), 1, 1e-6);
        }
      }
    }
  EXPECT_GT(colliding, 20);
  EXPECT_GT(apart, 10);
}

// The first bounds of a search come from the frame before; its results do not.
TEST(RigidBodies, AnswersDoNotDependOnEarlierFrames) {
  const Shape cow(load("cow.off", "fit")), knot(placed(torus(24, 12), "fit"));
  const ProximityOptions options{.contact_margin = 0.02};
  ProximityQuery query(cow, knot, options);
  std::mt19937 random(5);
  Transform pose;
  int colliding = 0;
  for (int frame = 0; frame < 1000; ++frame) {
    SCOPED_TRACE(frame);
    std::uniform_real_distribution<double> step(-0.02, 0.02);
    if (frame % 50 == 0) pose = random_pose(random, 0.6, false);
    pose = Transform::translation({step(random), step(random), step(random)}) * pose;
    query.set_pose(1, pose);
    ProximityQuery fresh(cow, knot, options);
    fresh.set_pose(1, pose);
    expect_equal(query, fresh);
    if (HasFailure()) return;
    colliding += query.colliding();
  }
  EXPECT_GT(colliding, 200);
  EXPECT_LT(colliding, 800);
}

// A solver finds the contacts of the frame before by their numbers.
TEST(RigidBodies, ContactsKeepTheirIds) {
  ProximityQuery query(cube(), cube(), {.contact_margin = 0.05});
  query.set_pose(0, Transform::translation({0.1, 0.2, 2.01}));
  std::set<std::uint64_t> before;
  for (const Contact& c : query.contacts()) EXPECT_TRUE(before.insert(c.id).second);
  ASSERT_EQ(before.size(), 6u);  // a corner of each, and where the edges cross, those of both
  query.set_pose(0, Transform::translation({0.1003, 0.2, 2.009}) * Transform::rotation({0.01, 0, 0}));
  std::size_t kept = 0;
  for (const Contact& c : query.contacts()) kept += before.contains(c.id);
  EXPECT_GE(kept + 1, before.size());
}

TEST(RigidBodies, CostNoMemoryForEachPose) {
  const ThreadLimit alone(1);
  const Shape shape(sphere(4));
  ProximityQuery query(shape, shape, {.contact_margin = 0.01});
  const auto taken = [&] {
    const std::size_t before = allocations();
    for (const double x : {1.5, 1.9, 2.005, 7.0}) {
      query.set_pose(1, Transform::translation({x, 0.1, 0}));
      (void)query.separation();
      (void)query.colliding();
      (void)query.penetration_depth();
      (void)query.contacts();
    }
    return allocations() - before;
  };
  (void)taken();
  EXPECT_EQ(taken(), 0u);
}

// Run under ThreadSanitizer as well.
TEST(RigidBodies, ShareTheirShapeBetweenThreads) {
  const std::vector<Mesh> meshes = various();
  std::vector<Shape> shapes;
  for (const Mesh& mesh : meshes) shapes.emplace_back(mesh, kAtlas);
  struct Result {
    double separation, lower, upper;
    std::size_t contacts;
    bool operator==(const Result&) const = default;
  };
  const auto results = [&](unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Result> found;
    for (int i = 0; i < 10; ++i) {
      ProximityQuery query(shapes[random() % shapes.size()], shapes[random() % shapes.size()]);
      query.set_pose(0, random_pose(random, 0.3, true));
      const BoundedLength depth = query.penetration_depth().value_or(BoundedLength{});
      found.push_back({query.separation().value, depth.lower, depth.upper, query.contacts().size()});
    }
    return found;
  };
  constexpr unsigned kThreads = 4;
  std::array<std::vector<Result>, kThreads> found;
  {
    std::vector<std::jthread> threads;
    for (unsigned t = 0; t < kThreads; ++t) threads.emplace_back([&, t] { found[t] = results(t); });
  }
  for (unsigned t = 0; t < kThreads; ++t) EXPECT_EQ(found[t], results(t));
}

TEST(RigidBodies, ShareTheirShape) {
  Shape shape(cube());
  const std::vector<Vec3> larger = in_pose(cube(), Transform::scaling(2));
  ProximityQuery query(shape, Shape(cube()));
  EXPECT_EQ(&query.sites(0), &shape.sites());
  query.set_pose(1, Transform::translation({5, 0, 0}));
  EXPECT_EQ(query.separation().value, 3);
  try {
    query.refit(larger, {});
    FAIL() << "the shape is shared";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("shared"), std::string::npos);
  }
  query.refit({}, larger);  // the second one deforms in its pose
  EXPECT_EQ(query.separation().value, 2);
  shape = Shape(cube());
  query.refit(larger, {});  // no longer shared
  EXPECT_EQ(query.separation().value, 1);
}

TEST(RigidBodies, RejectPosesThatAreNotRigid) {
  ProximityQuery query(cube(), cube());
  query.set_pose(1, Transform::translation({5, 0, 0}));
  Transform shear, reflection = Transform::scaling(-1), flat = Transform::scaling(0), projective, nan;
  shear.rows[0][1] = 0.01;
  projective.rows[3][0] = 0.1;
  nan.rows[1][3] = std::nan("");
  for (const Transform& pose : {shear, reflection, flat, projective, nan}) {
    EXPECT_THROW(query.set_pose(1, pose), Error);
    EXPECT_EQ(query.separation().value, 3);
  }
  EXPECT_THROW((void)Transform::quaternion({0, 0, 0, 0}), Error);
  EXPECT_THROW((void)Transform::quaternion({std::nan(""), 0, 0, 1}), Error);
  // In single precision.
  Transform rough = Transform::rotation({20, 30, 40});
  for (auto& row : rough.rows)
    for (double& x : row) x = static_cast<float>(x);
  query.set_pose(1, rough);
  const Transform used = query.pose(1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double product = 0;
      for (int k = 0; k < 3; ++k) product += used.rows[i][k] * used.rows[j][k];
      EXPECT_NEAR(product, i == j ? 1 : 0, 2e-7) << "a rotation times a scale";
      EXPECT_NEAR(used.rows[i][j], rough.rows[i][j], 1e-6);
    }
}

// Regression: beyond, the separation was infinite, and said to be exact.
TEST(RigidBodies, RejectPosesThatLeaveTheRangeOfMeshes) {
  ProximityQuery query(cube(), cube());
  MultiBodyQuery bodies(std::vector{cube(), cube()});
  const auto expect_unchanged = [&](double separation) {
    EXPECT_EQ(query.separation().value, separation);
    EXPECT_EQ(bodies.separations()[0].separation.value, separation);
  };
  for (const double far : {5.0, 1e20, 9e36}) {
    query.set_pose(1, Transform::translation({far, 0, 0}));
    bodies.set_pose(1, Transform::translation({far, 0, 0}));
    expect_unchanged(far - 2);
    EXPECT_EQ(query.separation().certainty, Certainty::exact);
  }
  query.set_pose(1, Transform::translation({5, 0, 0}));
  bodies.set_pose(1, Transform::translation({5, 0, 0}));
  for (const double far : {1.1e37, -1e38, 1e155, 1e300})
    for (const Transform& pose : {Transform::translation({0, far, 0}), Transform::scaling(std::abs(far))}) {
      EXPECT_THROW(query.set_pose(0, pose), Error);
      EXPECT_THROW(query.set_pose(1, pose), Error);
      EXPECT_THROW(bodies.set_pose(1, pose), Error);
      EXPECT_THROW(bodies.set_poses(std::vector{Transform(), pose}), Error);
      expect_unchanged(3);
    }
  EXPECT_THROW(query.set_pose(1, Transform::scaling(1e-31)), Error);
  expect_unchanged(3);
}

// So that a body does not leave it later, either.
TEST(RigidBodies, RejectShapesThatLeaveTheRangeInTheirPose) {
  Mesh large = cube();
  for (Vec3& p : large.positions) p = 10.0 * p;
  ProximityQuery query(cube(), cube());
  query.set_pose(1, Transform::scaling(5e36));
  EXPECT_THROW(query.refit({}, large.positions), Error);
  EXPECT_THROW(query.replace(1, Shape(large)), Error);
  EXPECT_THROW(query.edit(1, {.moved_vertices = {{0, {9, 9, 9}}}}), Error);
  EXPECT_EQ(query.sites(1).mesh().positions, cube().positions);
  query.refit({}, cube(1.5).positions);
  EXPECT_TRUE(std::isfinite(query.separation().value));
}

// Bodies of two shapes, one of which deforms.
class SharedShapes : public testing::Test {
 protected:
  std::vector<Mesh> meshes_ = various();
  std::vector<std::size_t> mesh_of_{0, 1, 0, 2, 1, 0, 3};
  std::vector<Transform> poses_;

  MultiBodyQuery query(const ProximityOptions& options) {
    std::mt19937 random(11);
    std::vector<Shape> shapes, bodies;
    for (const Mesh& mesh : meshes_) shapes.emplace_back(mesh, kAtlas);
    for (const std::size_t mesh : mesh_of_) {
      bodies.push_back(shapes[mesh]);
      poses_.push_back(random_pose(random, 0.9, mesh == 1));
    }
    MultiBodyQuery result(std::move(bodies), options);
    result.set_poses(poses_);
    return result;
  }
  [[nodiscard]] ProximityQuery pair(std::size_t a, std::size_t b, double margin) const {
    ProximityQuery query(meshes_[mesh_of_[a]], meshes_[mesh_of_[b]], {.contact_margin = margin});
    query.set_pose(0, poses_[a]);
    query.set_pose(1, poses_[b]);
    return query;
  }
};

TEST_F(SharedShapes, HaveTheAnswersOfPairs) {
  constexpr double kSharedMargin = 0.1;
  MultiBodyQuery bodies = query({.contact_margin = kSharedMargin});
  const std::span<const PairContacts> contacts = bodies.contacts();
  auto touching = contacts.begin();
  const std::span<const PairSeparation> separations = bodies.separations(0.5);
  const std::span<const PairDepth> depths = bodies.penetration_depths();
  auto found = separations.begin();
  auto depth = depths.begin();
  std::size_t colliding = 0;
  for (std::uint32_t a = 0; a < bodies.size(); ++a)
    for (std::uint32_t b = a + 1; b < bodies.size(); ++b) {
      SCOPED_TRACE(std::to_string(a) + ' ' + std::to_string(b));
      ProximityQuery expected = pair(a, b, kSharedMargin);
      if (!expected.contacts().empty()) {
        ASSERT_NE(touching, contacts.end());
        ASSERT_EQ(std::pair(touching->first, touching->second), std::pair(a, b));
        ASSERT_EQ(touching->contacts.size(), expected.contacts().size());
        for (std::size_t i = 0; i < expected.contacts().size(); ++i)
          expect_equal(touching->contacts[i], expected.contacts()[i]);
        ++touching;
      }
      if (expected.separation().value > 0.5 && !expected.colliding()) continue;
      ASSERT_NE(found, separations.end());
      ASSERT_EQ(std::pair(found->first, found->second), std::pair(a, b));
      expect_equal(found->separation, expected.separation());
      EXPECT_EQ(found->colliding, expected.colliding());
      if (found->colliding && expected.penetration_depth()) {
        ASSERT_NE(depth, depths.end());
        ASSERT_EQ(std::pair(depth->first, depth->second), std::pair(a, b));
        expect_equal((depth++)->penetration_depth, *expected.penetration_depth());
      }
      colliding += found->colliding;
      ++found;
    }
  EXPECT_EQ(touching, contacts.end());
  EXPECT_EQ(found, separations.end());
  EXPECT_EQ(depth, depths.end());
  EXPECT_GE(colliding, 2u);
  EXPECT_FALSE(contacts.empty());
}

TEST_F(SharedShapes, HaveTheMapsOfMovedVertices) {
  const MultiBodyQuery posed = query({});
  std::vector<Mesh> meshes;
  std::vector<std::vector<Vec3>> positions;
  for (std::size_t b = 0; b < mesh_of_.size(); ++b) {
    meshes.push_back(meshes_[mesh_of_[b]]);
    positions.push_back(in_pose(meshes.back(), poses_[b]));
  }
  MultiBodyQuery moved(with_atlases(meshes, kAtlas.resolution));
  moved.refit(std::vector<std::span<const Vec3>>(positions.begin(), positions.end()));
  for (std::size_t b = 0; b < mesh_of_.size(); ++b) {
    SCOPED_TRACE(b);
    const NearestMap p = posed.nearest_map(b), m = moved.nearest_map(b);
    ASSERT_EQ(p.map.distance.size(), m.map.distance.size());
    std::size_t wrong = 0, inside = 0;
    for (std::size_t i = 0; i < p.map.distance.size(); ++i) {
      if (std::isnan(m.map.distance[i])) {
        wrong += !std::isnan(p.map.distance[i]);
        continue;
      }
      inside += m.map.distance[i] < 0;
      const Vec3f& v = p.map.vector[i];
      wrong += !(std::abs(std::abs(p.map.distance[i]) - std::abs(m.map.distance[i])) < 1e-5) ||
               !(std::abs(norm(Vec3{v[0], v[1], v[2]}) - std::abs(p.map.distance[i])) < 1e-5) ||
               ((p.map.distance[i] < 0) != (m.map.distance[i] < 0) && p.body[i] == m.body[i] &&
                std::abs(m.map.distance[i]) > 1e-5);
    }
    EXPECT_EQ(wrong, 0u);
    const std::vector<float> at_p = nearest_distances_at_vertices(posed, b, 10),
                             at_m = nearest_distances_at_vertices(moved, b, 10);
    ASSERT_EQ(at_p.size(), at_m.size());
    for (std::size_t v = 0; v < at_p.size(); ++v) ASSERT_NEAR(std::abs(at_p[v]), std::abs(at_m[v]), 1e-5);
  }
}

TEST_F(SharedShapes, RejectMismatchedPoses) {
  MultiBodyQuery bodies = query({.contact_margin = 0.1});
  const std::size_t contacts = bodies.contacts().size();
  std::vector<Transform> poses = poses_;
  poses[6] = Transform::scaling(-1);
  EXPECT_THROW(bodies.set_poses(poses), Error);
  EXPECT_THROW(bodies.set_poses(std::span(poses_).first(3)), Error);
  EXPECT_THROW(bodies.set_pose(7, Transform()), Error);
  EXPECT_THROW((void)bodies.pose(7), Error);
  EXPECT_THROW(bodies.refit(0, meshes_[0].positions), Error) << "shared";
  EXPECT_EQ(bodies.contacts().size(), contacts);
  EXPECT_THROW(MultiBodyQuery(std::vector{Shape(cube())}, {.contact_margin = -1}), Error);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(bodies.pose(2).rows[i][3], poses_[2].rows[i][3], 1e-15);
}

TEST_F(SharedShapes, AllocateNothingAfterTheFirstFrames) {
  const ThreadLimit alone(1);
  mesh_of_ = {0, 1, 0, 1, 0, 3};  // a solid that intersects itself needs memory for its boundary
  MultiBodyQuery bodies = query({.contact_margin = 0.05});
  const auto taken = [&] {
    const std::size_t before = allocations();
    for (int frame = 0; frame < 4; ++frame) {
      for (std::size_t b = 0; b < bodies.size(); ++b)
        bodies.set_pose(b,
                        Transform::translation({0.05 * frame, 0, 0.03 * static_cast<double>(b)}) * poses_[b]);
      (void)bodies.separations(0.5);
      (void)bodies.penetration_depths();
      (void)bodies.contacts();
    }
    return allocations() - before;
  };
  (void)taken();
  EXPECT_EQ(taken(), 0u);
}

}  // namespace
}  // namespace sdm::test

// Collisions of convex solids in several poses at once, against the search of trees for each.
#include "bodies/convex/pose_packet.h"

#include <gmock/gmock.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "bodies/pairs/collision.h"
#include "mesh/similarity.h"
#include "poses.h"
#include "support/shapes.h"

namespace sdm::convex {
namespace {

Mesh stretched(Mesh mesh, const Vec3& by, const Vec3& offset = {}) {
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = by[k] * p[k] + offset[k];
  return mesh;
}

struct Solids {
  std::string name;
  Mesh resting, moving;
  bool plain = true;  // neither thin nor far from the origin: most poses are decided
};

std::vector<Solids> solids() {
  using test::cube, test::sphere, test::tetrahedron;
  return {{"cubes", cube(), cube(0.7)},
          {"tetrahedron and cube", tetrahedron(), cube(0.3)},
          {"ellipsoids of 20", stretched(sphere(0), {1, 0.7, 0.5}), stretched(sphere(0), {0.6, 0.9, 0.8})},
          {"ellipsoids of 80", stretched(sphere(1), {1, 0.7, 0.5}), stretched(sphere(1), {0.6, 0.9, 0.8})},
          {"of different size", stretched(sphere(1), {1e-2, 1e-2, 1e-2}), cube(2)},
          {"inside out", test::flipped(sphere(1)), test::flipped(cube())},
          {"needles", stretched(sphere(1), {1, 1e-3, 1e-3}), stretched(cube(), {1e-3, 1e-4, 1}), false},
          {"flat boxes", stretched(cube(), {1, 1, 1e-4}), stretched(cube(), {1, 0.5, 1e-6}), false},
          {"far from the origin", stretched(sphere(1), {1, 1, 1}, {1e4, -1e4, 3e3}),
           stretched(cube(), {1, 1, 1}, {5e3, 0, 0}), false},
          {"large", stretched(sphere(3), {1, 0.7, 0.5}), cube(), false}};
}

/// A body at rest and one that moves.
class PosePackets : public testing::Test {
 protected:
  void set(const Solids& solids, const Transform& rest) {
    resting_ = std::make_unique<Sites>(solids.resting);
    moving_ = std::make_unique<Sites>(solids.moving);
    convex_resting_ = recognise(internals(*resting_));
    convex_moving_ = recognise(internals(*moving_));
    ASSERT_TRUE(convex_resting_ && convex_moving_);
    rest_ = mesh::Similarity::of(rest);
    decided_ = 0;
  }
  [[nodiscard]] std::vector<Relation> relations(std::span<const Transform> poses) const {
    const PosePacket packet(*convex_moving_, *convex_resting_, rest_);
    std::vector<Relation> result(poses.size());
    for (std::size_t i = 0; i < poses.size(); i += PosePacket::kPoses) {
      const std::size_t count = std::min(PosePacket::kPoses, poses.size() - i);
      packet.decide(poses.subspan(i, count), std::span(result).subspan(i, count));
    }
    return result;
  }
  /// What is decided is so.
  void expect_right(std::span<const Transform> poses) {
    const std::vector<Relation> found = relations(poses);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (found[i] == Relation::unknown) continue;
      ++decided_;
      const Affine pose = inverse(rest_.map) * mesh::Similarity::of(poses[i]).map;
      const pairs::MeshPair pair{internals(*resting_), internals(*moving_), pose};
      EXPECT_EQ(found[i], pairs::colliding(pair, workspace_) ? Relation::overlap : Relation::apart) << i;
    }
  }

  std::unique_ptr<Sites> resting_, moving_;
  std::unique_ptr<const ConvexMesh> convex_resting_, convex_moving_;
  mesh::Similarity rest_;
  pairs::PairWorkspace workspace_;
  std::size_t decided_ = 0;
};

Transform rounded_to_float(Transform pose) {
  for (auto& row : pose.rows)
    for (double& x : row) x = static_cast<float>(x);
  return pose;
}

TEST_F(PosePackets, HaveTheAnswersOfSearches) {
  const Transform rest = Transform::translation({0.3, -2, 1}) * Transform::rotation({20, 130, 50});
  for (const Solids& solids : solids()) {
    SCOPED_TRACE(solids.name);
    set(solids, rest);
    std::mt19937 random(6);
    std::vector<Transform> poses, rounded;
    for (const Affine& pose : bench::random_poses(*resting_, *moving_, 500, random)) {
      poses.push_back(rest * mesh::Similarity{.map = pose}.transform());
      rounded.push_back(rounded_to_float(poses.back()));
    }
    expect_right(poses);
    // Of five stands, one only touches and one is near.
    if (solids.plain) {
      EXPECT_GT(decided_, 3 * poses.size() / 5);
    }
    decided_ = 0;
    expect_right(rounded);
    if (solids.plain) {
      EXPECT_GT(decided_, poses.size() / 2) << "in single precision";
    }
  }
}

// Bodies that touch, moved by parts of the margins in which nothing is decided, and by more.
TEST_F(PosePackets, AreNotDecidedWithinRounding) {
  for (const Solids& solids : solids()) {
    SCOPED_TRACE(solids.name);
    set(solids, {});
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const double size = convex_resting_->size + convex_moving_->size;
    std::vector<Transform> poses;
    std::size_t stand = 0;
    for (const Affine& pose : bench::random_poses(*resting_, *moving_, 100, random)) {
      if (bench::kStands[stand++ % std::size(bench::kStands)] != bench::Stand::touching) continue;
      for (const double by : {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3})
        for (int i = 0; i < 8; ++i) {
          Affine moved = pose;
          for (double& x : moved.offset) x += by * size * normal(random);
          poses.push_back(mesh::Similarity{.map = moved}.transform());
        }
    }
    expect_right(poses);
    EXPECT_LT(decided_, poses.size());
  }
}

TEST_F(PosePackets, HaveThemInSpecialPoses) {
  for (const Mesh& mesh : {test::cube(), test::cube(0.5), test::sphere(1), test::tetrahedron()}) {
    set({"", test::cube(), mesh}, Transform::scaling(1));
    std::vector<Transform> poses;
    for (const double x : {0.0, 0.5, 1.0, 1.5, 2.0, 2.0 + 1e-15, 2.0 + 1e-7, 2.0 - 1e-7, 3.0, 1e5, 1e30})
      for (const double y : {0.0, 0.25, 2.0, 2.5})
        for (const double z : {0.0, 1e-13, 2.0})
          for (const double angle : {0.0, 45.0, 90.0, 1e-7})
            poses.push_back(Transform::translation({x, y, z}) * Transform::rotation({0, 0, angle}));
    expect_right(poses);
    EXPECT_GT(decided_, poses.size() / 2);
  }
}

TEST_F(PosePackets, MayBeOfAScaledBodyAtRest) {
  set(solids()[0], Transform::translation({1, 0, 0}) * Transform::scaling(0.3));
  std::mt19937 random(8);
  std::uniform_real_distribution<double> at(-1.5, 1.5), angle(-180, 180);
  std::vector<Transform> poses;
  for (int i = 0; i < 500; ++i)
    poses.push_back(Transform::translation({at(random), at(random), at(random)}) *
                    Transform::rotation({angle(random), angle(random), angle(random)}));
  expect_right(poses);
  EXPECT_GT(decided_, 9 * poses.size() / 10);
}

TEST_F(PosePackets, LeaveOtherPosesOpen) {
  set(solids()[0], {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Transform> poses{Transform::scaling(2), Transform::scaling(-1), Transform::scaling(0),
                               Transform::translation({nan, 0, 0}), Transform::translation({1e300, 0, 0})};
  poses.emplace_back().rows[3][3] = 2;
  poses.emplace_back().rows[1][1] = nan;
  poses.emplace_back().rows[0][1] = 1e-3;
  EXPECT_THAT(relations(poses), testing::Each(Relation::unknown));
}

}  // namespace
}  // namespace sdm::convex

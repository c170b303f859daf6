// One shape in many poses, against a ProximityQuery for each.
#include <gmock/gmock.h>
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/allocations.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// A body that moves among three obstacles, of which the last one has no inside.
class ManyPoses : public testing::Test {
 protected:
  Shape shape_{placed(torus(16, 8), "fit")};
  std::vector<Shape> obstacles_{Shape(sphere(2)), Shape(cube(0.4)), Shape(band(12, false))};
  std::vector<Transform> places_{Transform(), Transform::translation({1.5, 0, 0.2}),
                                 Transform::translation({0, 2, 0})};
  std::vector<Transform> poses_;

  void SetUp() override {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-1.5, 1.5), angle(-180, 180);
    for (int i = 0; i < 150; ++i)
      poses_.push_back(Transform::translation({place(random), place(random), place(random)}) *
                       Transform::rotation({angle(random), angle(random), angle(random)}));
  }
  [[nodiscard]] PoseQuery query() const {
    PoseQuery result(shape_, obstacles_);
    for (std::size_t i = 0; i < places_.size(); ++i) result.set_pose(i, places_[i]);
    return result;
  }
  [[nodiscard]] ProximityQuery pair(const Transform& pose, std::size_t obstacle) const {
    ProximityQuery result(shape_, obstacles_[obstacle]);
    result.set_pose(0, pose);
    result.set_pose(1, places_[obstacle]);
    return result;
  }
};

TEST_F(ManyPoses, HaveTheAnswersOfPairs) {
  PoseQuery query = this->query();
  const std::vector<std::uint8_t> colliding = query.colliding(poses_);
  const std::vector<double> separations = query.separations(poses_), near = query.separations(poses_, 0.5);
  const std::vector<BoundedNumber> depths = query.penetration_depths(poses_);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    SCOPED_TRACE(i);
    bool hit = false;
    double least = kInfinity;
    BoundedNumber deepest;
    for (std::size_t obstacle = 0; obstacle < obstacles_.size(); ++obstacle) {
      ProximityQuery expected = pair(poses_[i], obstacle);
      hit = hit || expected.colliding();
      least = std::min(least, expected.separation().value);
      const BoundedLength& depth = *expected.penetration_depth();
      deepest = {.value = std::max(deepest.value, depth.value),
                 .lower = std::max(deepest.lower, depth.lower),
                 .upper = std::max(deepest.upper, depth.upper)};
    }
    EXPECT_EQ(colliding[i] != 0, hit);
    EXPECT_EQ(separations[i], least);
    EXPECT_EQ(near[i], least <= 0.5 ? least : kInfinity);
    EXPECT_EQ(depths[i].value, deepest.value);
    EXPECT_EQ(depths[i].lower, deepest.lower);
    EXPECT_EQ(depths[i].upper, deepest.upper);
    EXPECT_EQ(depths[i].certainty, hit ? Certainty::bounded : Certainty::exact);
  }
  EXPECT_GT(std::ranges::count(colliding, 1), 20);
  EXPECT_GT(std::ranges::count(near, kInfinity), 5);
}

TEST_F(ManyPoses, DoNotDependOnTheirOrderOrTheThreads) {
  PoseQuery query = this->query();
  const std::vector<std::uint8_t> colliding = query.colliding(poses_);
  std::vector<double> separations = query.separations(poses_, 2);
  std::ranges::reverse(poses_);
  const ThreadLimit alone(1);
  PoseQuery other = this->query();
  std::vector<std::uint8_t> reversed(poses_.size());
  other.colliding(poses_, reversed);
  std::ranges::reverse(reversed);
  EXPECT_EQ(colliding, reversed);
  std::ranges::reverse(separations);
  EXPECT_EQ(other.separations(poses_, 2), separations);
}

TEST_F(ManyPoses, AllocateTheResultsOnly) {
  const ThreadLimit alone(1);
  PoseQuery query = this->query();
  std::vector<double> separations(poses_.size());
  std::vector<BoundedNumber> depths(poses_.size());
  for (int i = 0; i < 2; ++i) {
    (void)query.colliding(poses_);
    query.separations(poses_, 1, separations);
    query.penetration_depths(poses_, depths);
  }
  std::size_t before = allocations();
  query.separations(poses_, 1, separations);
  query.penetration_depths(poses_, depths);
  EXPECT_EQ(allocations() - before, 0u);
  before = allocations();
  (void)query.colliding(poses_);
  EXPECT_EQ(allocations() - before, 1u);
}

// Of convex solids, many poses are decided at once; what is not, and the other obstacles, one by one.
TEST_F(ManyPoses, OfConvexSolidsHaveTheAnswersOfPairs) {
  shape_ = Shape(cube(0.3));
  obstacles_.push_back(shape_);
  places_.push_back(Transform::translation({-1, -1, -1}) * Transform::scaling(0.5));
  for (const double x : {0.7, 0.7 - 1e-9, 0.7 + 1e-9, 0.7 - 1e-3})  // beside the cube
    poses_.push_back(Transform::translation({1.5 + x, 0, 0.2}));
  for (std::size_t count : {4u, 2u}) {  // the first two of which are convex
    obstacles_.erase(obstacles_.begin() + static_cast<std::ptrdiff_t>(count), obstacles_.end());
    places_.resize(count);
    PoseQuery query = this->query();
    const std::vector<std::uint8_t> colliding = query.colliding(poses_);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      bool hit = false;
      for (std::size_t obstacle = 0; obstacle < count; ++obstacle)
        hit = hit || pair(poses_[i], obstacle).colliding();
      EXPECT_EQ(colliding[i] != 0, hit) << i;
    }
    EXPECT_GT(std::ranges::count(colliding, 1), 10);
    EXPECT_GT(std::ranges::count(colliding, 0), 10);
  }
  const ThreadLimit alone(1);
  PoseQuery query = this->query();
  std::vector<std::uint8_t> results(poses_.size());
  for (int i = 0; i < 2; ++i) query.colliding(poses_, results);
  const std::size_t before = allocations();
  query.colliding(poses_, results);
  EXPECT_EQ(allocations() - before, 0u);
  poses_[70].rows[0][0] = 9;
  EXPECT_THAT([&] { query.colliding(poses_, results); },
              testing::ThrowsMessage<Error>(testing::StartsWith("pose 70: ")));
  PoseQuery none(shape_, std::vector<Shape>{});
  EXPECT_THROW(none.colliding(poses_, results), Error);
}

TEST_F(ManyPoses, OfOpenSurfacesHaveNoDepth) {
  PoseQuery query(obstacles_[2], obstacles_[2]);
  for (const BoundedNumber& depth : query.penetration_depths(poses_)) {
    EXPECT_TRUE(std::isnan(depth.value));
    EXPECT_TRUE(std::isnan(depth.upper));
  }
  PoseQuery alone(shape_, std::vector<Shape>{});
  EXPECT_THAT(alone.colliding(poses_), testing::Each(0));
  EXPECT_THAT(alone.separations(poses_), testing::Each(kInfinity));
  EXPECT_TRUE(alone.colliding({}).empty());
}

TEST_F(ManyPoses, RejectWhatIsOutOfRange) {
  PoseQuery query = this->query();
  std::vector<std::uint8_t> few(3);
  EXPECT_THROW(query.colliding(poses_, few), Error);
  EXPECT_THROW((void)query.separations(poses_, 0), Error);
  EXPECT_THROW((void)query.separations(poses_, std::nan("")), Error);
  EXPECT_THROW(query.set_pose(3, {}), Error);
  EXPECT_THROW(query.set_pose(0, Transform::scaling(-1)), Error);
  EXPECT_THROW(PoseQuery(shape_, obstacles_, {.depth_precision = 0}), Error);
  poses_[70].rows[0][0] = 9;
  try {
    (void)query.colliding(poses_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("pose 70: "));
  }
}

}  // namespace
}  // namespace sdm::test

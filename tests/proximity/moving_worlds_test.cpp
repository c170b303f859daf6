// Worlds of which some bodies move, against worlds that are built anew and against single pairs.
#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/sdm.h>

#include <random>
#include <set>
#include <vector>

#include "support/allocations.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// All numbers of a world's answers.
struct WorldAnswers {
  std::vector<double> numbers;

  void add(auto... values) { (numbers.push_back(static_cast<double>(values)), ...); }
  void add_length(const BoundedLength& length) {
    add(length.value, length.lower, length.upper, length.certainty);
    if (length.witness)
      for (const Vec3& p : *length.witness) add(p[0], p[1], p[2]);
  }
  void add_contact(const Contact& c) {
    for (const Vec3& p : {c.point1, c.point2, c.normal}) add(p[0], p[1], p[2]);
    add(c.depth, c.patch, c.on[0].face, c.on[1].face, c.id >> 32, c.id & 0xFFFFFFFF);
  }
  bool operator==(const WorldAnswers&) const = default;
};

/// The calls of a world, each with its answers.
enum class Call { colliding, separations, depths, contacts };
constexpr std::array kCalls{Call::colliding, Call::separations, Call::depths, Call::contacts};

WorldAnswers answers_to(Call call, MultiBodyQuery& world, double max_distance) {
  WorldAnswers answers;
  if (call == Call::colliding)
    for (const BodyPair& pair : world.colliding()) answers.add(pair.first, pair.second);
  if (call == Call::separations)
    for (const PairSeparation& pair : world.separations(max_distance)) {
      answers.add(pair.first, pair.second, pair.colliding);
      answers.add_length(pair.separation);
    }
  if (call == Call::depths)
    for (const PairDepth& pair : world.penetration_depths()) {
      answers.add(pair.first, pair.second);
      answers.add_length(pair.penetration_depth);
    }
  if (call == Call::contacts)
    for (const PairContacts& pair : world.contacts()) {
      answers.add(pair.first, pair.second);
      for (const Contact& contact : pair.contacts) answers.add_contact(contact);
    }
  return answers;
}

/// By a ProximityQuery of each pair that `meets`.
template <class Meets>
WorldAnswers answers_of_pairs(Call call, const std::vector<Shape>& shapes,
                              const std::vector<Transform>& poses, double margin, double max_distance,
                              const Meets& meets) {
  WorldAnswers answers;
  for (std::uint32_t a = 0; a < shapes.size(); ++a)
    for (std::uint32_t b = a + 1; b < shapes.size(); ++b) {
      if (!meets(a, b)) continue;
      ProximityQuery query(shapes[a], shapes[b], {.contact_margin = margin});
      query.set_pose(0, poses[a]);
      query.set_pose(1, poses[b]);
      if (call == Call::colliding && query.colliding()) answers.add(a, b);
      if (call == Call::separations && (query.colliding() || query.separation().value <= max_distance)) {
        answers.add(a, b, query.colliding());
        answers.add_length(query.separation());
      }
      if (call == Call::depths && query.colliding() && query.penetration_depth()) {
        answers.add(a, b);
        answers.add_length(*query.penetration_depth());
      }
      if (call == Call::contacts && !query.contacts().empty()) {
        answers.add(a, b);
        for (const Contact& contact : query.contacts()) answers.add_contact(contact);
      }
    }
  return answers;
}

constexpr double kMargin = 0.03;

/// Bodies of a few shapes, of which some are inside others, in random poses.
class MovingWorlds : public testing::Test {
 protected:
  std::mt19937 random_{7};
  std::vector<Shape> kinds_{Shape(sphere(2)), Shape(cube(0.4)), Shape(placed(torus(12, 8), "fit")),
                            Shape(band(12, false)), Shape(cube(3))};
  std::vector<Shape> shapes_;
  std::vector<Transform> poses_;

  void make(std::size_t bodies) {
    for (std::size_t i = 0; i < bodies; ++i) {
      shapes_.push_back(kinds_[i % 4]);
      poses_.push_back(random_pose());
    }
    shapes_.back() = kinds_[4];  // around many others
  }
  Transform random_pose() {
    std::uniform_real_distribution<double> place(-4, 4), angle(-180, 180);
    return Transform::translation({place(random_), place(random_), place(random_)}) *
           Transform::rotation({angle(random_), angle(random_), angle(random_)});
  }
  [[nodiscard]] MultiBodyQuery world() const {
    MultiBodyQuery result(shapes_, {.contact_margin = kMargin});
    result.set_poses(poses_);
    return result;
  }
};

// Few or many move, by one pose or by all; any of the calls are made, in any order, with any distance.
TEST_F(MovingWorlds, HaveTheAnswersOfNewOnes) {
  make(100);
  MultiBodyQuery world = this->world();
  std::size_t answers = 0;
  for (int frame = 0; frame < 60; ++frame) {
    SCOPED_TRACE(frame);
    const std::size_t movers = std::array{0, 1, 2, 9, 70}[static_cast<std::size_t>(frame % 5)];
    for (std::size_t i = 0; i < movers; ++i) {
      const std::size_t body = random_() % shapes_.size();
      poses_[body] = frame % 3 == 0 ? random_pose() : Transform::translation({0.02, 0, 0}) * poses_[body];
      if (frame % 2 == 0) world.set_pose(body, poses_[body]);
    }
    if (frame % 2 == 1) world.set_poses(poses_);
    MultiBodyQuery anew = this->world();
    for (std::size_t i = 0; i < 3; ++i) {
      const Call call = kCalls[random_() % kCalls.size()];
      const double max_distance = std::array{0.1, 0.5, 2.0}[random_() % 3];
      const WorldAnswers found = answers_to(call, world, max_distance);
      ASSERT_EQ(found, answers_to(call, anew, max_distance)) << static_cast<int>(call);
      answers += found.numbers.size();
    }
  }
  EXPECT_GT(answers, 10000u);
}

TEST_F(MovingWorlds, HaveTheAnswersOfPairs) {
  make(24);
  for (Transform& pose : poses_)  // closer together
    for (int k = 0; k < 3; ++k) pose.rows[static_cast<std::size_t>(k)][3] *= 0.5;
  MultiBodyQuery world = this->world();
  const auto all = [](std::uint32_t, std::uint32_t) { return true; };
  for (int frame = 0; frame < 4; ++frame) {
    for (const Call call : kCalls) {
      SCOPED_TRACE(std::to_string(frame) + ' ' + std::to_string(static_cast<int>(call)));
      const WorldAnswers found = answers_to(call, world, 0.4);
      EXPECT_GT(found.numbers.size(), 20u);
      EXPECT_EQ(found, answers_of_pairs(call, shapes_, poses_, kMargin, 0.4, all));
    }
    const std::size_t body = random_() % shapes_.size();
    poses_[body] = Transform::translation({0.1, 0, 0.1}) * poses_[body];
    world.set_pose(body, poses_[body]);
  }
}

TEST_F(MovingWorlds, LeaveOutWhatTheFiltersExclude) {
  make(24);
  for (Transform& pose : poses_)
    for (int k = 0; k < 3; ++k) pose.rows[static_cast<std::size_t>(k)][3] *= 0.4;
  MultiBodyQuery world = this->world();
  std::vector<BodyFilter> filters(shapes_.size());
  std::set<Pair> excluded;
  const auto meets = [&](std::uint32_t a, std::uint32_t b) {
    return !(filters[a].fixed && filters[b].fixed) && (filters[a].groups & filters[b].mask) != 0 &&
           (filters[b].groups & filters[a].mask) != 0 && !excluded.contains({a, b});
  };
  for (int change = 0; change < 40; ++change) {
    SCOPED_TRACE(change);
    const std::size_t body = random_() % shapes_.size();
    filters[body] = {.fixed = change % 3 != 0,
                     .groups = 1u << random_() % 3,
                     .mask = static_cast<std::uint32_t>(1 + random_() % 7)};
    world.set_filter(body, filters[body]);
    EXPECT_EQ(world.filter(body).mask, filters[body].mask);
    const auto a = static_cast<std::uint32_t>(random_() % 12),
               b = 12 + static_cast<std::uint32_t>(random_() % 12);
    if (change % 4 != 3) {
      world.exclude_pair(b, a);
      world.exclude_pair(a, b);
      excluded.insert({a, b});
    } else {
      const Pair back = *excluded.begin();
      world.include_pair(back.second, back.first);
      excluded.erase(back);
    }
    if (change % 2 == 0) {
      const std::size_t mover = random_() % shapes_.size();
      poses_[mover] = Transform::translation({0, 0.1, 0}) * poses_[mover];
      world.set_pose(mover, poses_[mover]);
    }
    for (const Call call : {Call::colliding, Call::separations})
      ASSERT_EQ(answers_to(call, world, 0.4), answers_of_pairs(call, shapes_, poses_, kMargin, 0.4, meets));
  }
  for (std::size_t body = 0; body < shapes_.size(); ++body) world.set_filter(body, {.fixed = true});
  EXPECT_TRUE(world.separations().empty());
  EXPECT_EQ(world.candidate_pairs(), 0u);
}

TEST_F(MovingWorlds, CountThePairsWithinReachOnly) {
  make(30);
  MultiBodyQuery world = this->world();
  (void)world.separations();
  EXPECT_EQ(world.candidate_pairs(), 30u * 29 / 2);
  (void)world.separations(0.5);
  MultiBodyQuery anew = this->world();
  (void)anew.separations(0.5);
  EXPECT_EQ(world.candidate_pairs(), anew.candidate_pairs());
  EXPECT_LT(world.candidate_pairs(), 30u * 29 / 2);
}

TEST_F(MovingWorlds, CostNoMemoryForEachMotion) {
  const ThreadLimit alone(1);
  make(40);
  MultiBodyQuery world = this->world();
  const auto taken = [&] {
    const std::size_t before = allocations();
    for (int frame = 0; frame < 12; ++frame) {
      const std::size_t body = static_cast<std::size_t>(frame) % 3;
      for (const double x : {0.5, 0.0}) {
        world.set_pose(body, Transform::translation({x, 0, 0}) * poses_[body]);
        (void)world.separations(0.3);
        (void)world.colliding();
        (void)world.contacts();
        (void)world.penetration_depths();
      }
    }
    return allocations() - before;
  };
  (void)taken();
  EXPECT_EQ(taken(), 0u);
}

}  // namespace
}  // namespace sdm::test

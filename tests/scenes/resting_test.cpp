// Bodies come to rest on either kind of contacts, hardly enter each other, and never gain energy.
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/box_mesh.h"
#include "scenes/resting_bodies.h"
#include "support/every_case.h"

namespace sdm::scenes {
namespace {

using test::every_case;

constexpr double kRounding = 1e-9;  // of the energy that a fall by the size frees

struct Rest {
  double rise = 0;         // the largest gain of energy in a step, of m g size
  double penetration = 0;  // the largest, of the size
  double speed = 0;        // at the end, in sizes a second
};

Rest simulate(const RestingScene& scene, bool separating, double seconds) {
  RigidWorld world(scene.bodies, {.separating = separating});
  double weight = 0;
  for (const RigidStart& body : scene.bodies)
    if (!body.fixed) weight += 9.81 * mass_properties(body.shape.sites().mesh()).mass;
  Rest rest;
  double energy = world.energy();
  const int steps = static_cast<int>(240 * seconds);
  for (int step = 1; step <= steps; ++step) {
    world.step();
    rest.rise = std::max(rest.rise, (world.energy() - energy) / (weight * scene.size));
    energy = world.energy();
    if (step % 24 == 0) rest.penetration = std::max(rest.penetration, world.penetration() / scene.size);
  }
  rest.speed = world.speed() / scene.size;
  return rest;
}

void expect_rest(const RestingScene& scene, double seconds) {
  for (const bool separating : {false, true}) {
    const Rest rest = simulate(scene, separating, seconds);
    EXPECT_LE(rest.rise, kRounding) << scene.name << (separating ? ", separating" : "");
    EXPECT_LE(rest.penetration, 0.002) << scene.name << (separating ? ", separating" : "");
    EXPECT_LE(rest.speed, 1e-3) << scene.name << (separating ? ", separating" : "");
  }
}

TEST(Resting, Post) {
  expect_rest(post_on_floor(), every_case() ? 10 : 4);
}
TEST(Resting, Comb) {
  expect_rest(comb_on_floor(), every_case() ? 10 : 3);
}
TEST(Resting, Table) {
  expect_rest(table_on_floor(), every_case() ? 10 : 3);
}
TEST(Resting, Peg) {
  expect_rest(peg_in_hole(), every_case() ? 10 : 3);
}
TEST(Resting, Chain) {
  expect_rest(hanging_chain(every_case() ? 12 : 4), every_case() ? 20 : 4);
}
TEST(Resting, Bunnies) {
  expect_rest(every_case() ? bunnies_in_box(30, 300) : bunnies_in_box(3, 120), every_case() ? 10 : 4);
}

TEST(MassProperties, AreThoseOfABox) {
  const Box box{{1, 2, 3}, {2, 4, 6}};
  const MassProperties found = mass_properties(box_mesh(box));
  EXPECT_NEAR(found.mass, 6, 1e-12);
  EXPECT_LE(norm(found.centre - Vec3{1.5, 3, 4.5}), 1e-12);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const double squares[]{1, 4, 9};
      const double expected = i == k ? 6 * (14 - squares[i]) / 12 : 0;
      EXPECT_NEAR(found.inertia[i][k], expected, 1e-12);
    }
}

// A body that turns freely keeps its energy, and its angular momentum but for the order of the step.
TEST(RigidWorld, TurnsFreely) {
  RigidWorld world({{.shape = Shape(box_mesh({{-1, -0.5, -0.2}, {1, 0.5, 0.2}})), .spin = {0.1, 5, 0.1}}},
                   {.gravity = {}});
  const double energy = world.energy();
  for (int step = 0; step < 2400; ++step) world.step();
  EXPECT_NEAR(world.energy(), energy, 1e-9 * energy);
}

}  // namespace
}  // namespace sdm::scenes

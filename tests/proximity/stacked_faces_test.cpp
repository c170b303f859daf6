// Stacks of coplanar faces, of which nearly all pairs touch.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <ctime>
#include <random>

namespace sdm::test {
namespace {

// Squares in one plane, each moved by little.
Mesh stack_of_squares(std::uint32_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(0, 0.1);
  Mesh mesh;
  for (std::uint32_t k = 0; k < 4 * count; k += 4) {
    const double x = shift(random), y = shift(random);
    for (const Vec3& p : {Vec3{x, y, 0}, Vec3{x + 1, y, 0}, Vec3{x + 1, y + 1, 0}, Vec3{x, y + 1, 0}})
      mesh.positions.push_back(p);
    mesh.triangles.push_back({k, k + 1, k + 2});
    mesh.triangles.push_back({k, k + 2, k + 3});
  }
  return mesh;
}

/// Processor seconds since it was made.
struct ProcessorTime {
  const std::clock_t start = std::clock();

  [[nodiscard]] double seconds() const { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }
};

// Each edge touches nearly all faces: bisecting the distance to each took half a minute.
TEST(StackedFaces, ContactsAreFoundSoon) {
  const Mesh stack = stack_of_squares(1000);
  const ProcessorTime time;
  ProximityQuery query(stack, stack);
  EXPECT_FALSE(query.contacts().empty());
  EXPECT_LT(time.seconds(), 12);
  for (const Contact& c : query.contacts()) {
    ASSERT_EQ(c.depth, 0);
    ASSERT_EQ(c.point1[2], 0);
    ASSERT_EQ(c.patch, 0u);
  }
}

// Of those that touch, the first pair is the answer: comparing all took ten seconds.
TEST(StackedFaces, SelfDistancesAreFoundSoon) {
  const Mesh stack = stack_of_squares(1000);
  const ProcessorTime time;
  SelfProximityQuery query(stack);
  const auto separation = query.separation();
  const Surface surface(stack, {.resolution = 256});
  const DistanceMap map = compute_map(surface, query.sites(), SelfOptions{.exclusion = query.exclusion()});
  EXPECT_LT(time.seconds(), 6);
  ASSERT_TRUE(separation);
  EXPECT_EQ(separation->value, 0);
  EXPECT_GT(std::ranges::count(map.distance, 0.f), 10'000);
}

}  // namespace
}  // namespace sdm::test

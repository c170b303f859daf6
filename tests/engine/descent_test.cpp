// What the exactness tests do not see: the parts of the cpu engine, and how much work it does.
#include "engine/cpu/descent.h"
#include "core/vec.h"
#include "engine/support.h"
#include "mesh/sites_impl.h"

namespace sdm {
namespace {

Vec3f to_float(const Vec3& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

double distance(const float (&a)[3], const Vec3f& b) {
  return norm(Vec3{a[0], a[1], a[2]} - Vec3{b[0], b[1], b[2]});
}

TEST(PointGroup, BallsContainTheirPointsAndTheBallsBelow) {
  std::mt19937 random(4);
  const auto group = std::make_unique<PointGroup>();
  for (const std::size_t count : {1u, 15u, 16u, 17u, 64u, 65u, 1000u, 4097u, 65536u}) {
    SCOPED_TRACE(count);
    std::vector<Vec3f> points(count);
    for (Vec3f& p : points) p = to_float(test::random_point({{-1, -1, -1}, {1, 3, 1}}, random));
    group->place(points);
    ASSERT_EQ(group->balls[group->top].size(), 1u);
    for (int level = 0; level <= group->top; ++level) {
      const std::size_t size = PointGroup::points_at(level);
      ASSERT_EQ(group->balls[level].size(), (count + size - 1) / size);
      for (std::size_t i = 0; i < count; ++i) {
        const Ball& ball = group->balls[level][i / size];
        ASSERT_LE(distance(ball.centre, points[i]), 1.00001 * ball.radius + 1e-6);
      }
      for (std::size_t i = 0; level > 0 && i < group->balls[level - 1].size(); ++i) {
        const Ball &inner = group->balls[level - 1][i], &outer = group->balls[level][i / PointGroup::kFan];
        const Vec3f centre{inner.centre[0], inner.centre[1], inner.centre[2]};
        ASSERT_LE(distance(outer.centre, centre) + inner.radius, 1.00001 * outer.radius + 1e-6);
      }
    }
  }
}

DescentCounts work(const Surface& surface, const Sites& sites) {
  const auto descent = std::make_unique<Descent>();
  const std::span<const Vec3> points = surface.sample_points();
  for (std::size_t first = 0; first < points.size(); first += PointGroup::kMostPoints) {
    std::vector<Vec3f> unit;
    for (const Vec3& p : points.subspan(first, std::min(PointGroup::kMostPoints, points.size() - first)))
      unit.push_back(to_float(sites.impl().frame.to_unit(p)));
    descent->points.place(unit);
    find_winners(sites.impl().wide, sites.impl().regions, 1e18f, *descent);
  }
  return descent->counts;
}

// Lists are short, and what they save is traversal. Counts depend on the meshes alone, and hardly on
// rounding.
TEST(Descent, EvaluatesFewSites) {
  const Surface bunny(test::load("bunny.obj", "fit"), {.resolution = 1024});
  const double packets = static_cast<double>(bunny.samples().size()) / PointGroup::kPacket;
  const DescentCounts apart = work(bunny, Sites(test::load("armadillo.off", "fit,translate:0.8:0:0")));
  EXPECT_LT(static_cast<double>(apart.evaluations), 3 * packets);
  EXPECT_LT(static_cast<double>(apart.list_blocks), 5 * packets);
  EXPECT_LT(static_cast<double>(apart.tree_blocks), 10 * packets);
  const DescentCounts through = work(bunny, Sites(test::load("armadillo.off", "fit,translate:0.1:0:0")));
  EXPECT_LT(static_cast<double>(through.evaluations), 15 * packets);
  EXPECT_LT(static_cast<double>(through.tree_blocks), 50 * packets);
  EXPECT_GT(apart.groups, 0u);
  EXPECT_LT(static_cast<double>(through.groups), packets);
}

}  // namespace
}  // namespace sdm

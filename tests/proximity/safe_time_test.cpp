// Parts of moving bodies are apart until the time that was proven, by their extents at many times before.
#include "bodies/motion/safe_time.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "geometry/triangle_pair.h"
#include "support/shapes.h"

namespace sdm::motion {
namespace {

// A body on its way.
struct Moving {
  Shape shape;
  Motion path;
  DividedMotion motion;
  Parts parts;

  Moving(const Mesh& mesh, const Motion& p)
      : shape(mesh), path(p), motion(path, shape), parts({internals(shape.sites()), motion}) {}

  [[nodiscard]] Part face(std::uint32_t index) { return parts.at({.child = index, .face = true}); }
  [[nodiscard]] Part box() { return parts.at({}); }

  [[nodiscard]] std::vector<Vec3> all_corners(double time) const {
    std::vector<Vec3> points = shape.sites().mesh().positions;
    transform(points, path.at(time, shape));
    return points;
  }
  [[nodiscard]] Corners corners(std::uint32_t index, double time) const {
    const std::vector<Vec3> points = all_corners(time);
    const auto& [a, b, c] = shape.sites().mesh().triangles[index];
    return {points[a], points[b], points[c]};
  }
};

TEST(SafeTime, IsFreeOfContact) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> fraction(0, 1);
  const auto vector = [&](double size) {
    return size * Vec3{normal(random), normal(random), normal(random)};
  };
  constexpr double kReserve = 1e-3;
  int proven = 0, forever = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const auto pose = [&](double scale) {
      return Transform::translation(vector(2)) *
             Transform::quaternion({normal(random), normal(random), normal(random), normal(random)}) *
             Transform::scaling(scale);
    };
    const auto path = [&] {
      const double scale = std::exp(normal(random));
      Motion motion{pose(scale), pose(scale)};
      if (i % 5 == 1) motion.to = Transform::translation(vector(1)) * motion.from;
      if (i % 5 == 2) {  // about the origin of the mesh
        const Vec3 size = vector(1);
        motion.to = motion.from * Transform::rotation(180 * size);
      }
      return motion;
    };
    const Mesh mesh1 = test::soup(4, random), mesh2 = test::soup(4, random);
    Moving o1(mesh1, path()), o2(mesh2, path());
    SafeTime safe(o1.motion, o2.motion, kReserve);
    safe.set_now(i % 3 == 0 ? 0 : fraction(random));
    const auto expect_free = [&](const Part& part1, std::span<const Vec3> corners1, const Part& part2,
                                 std::span<const Vec3> corners2, const Vec3& u) {
      const double until = std::min(1.0, safe.until(part1, part2, u));
      ASSERT_GE(until, safe.now());
      // By the extents of the corners, which are those of all points.
      for (int step = 0; step <= 20 && until > safe.now(); ++step) {
        const double time = safe.now() + (until - safe.now()) * step / 20;
        const auto extent = [&](const Moving& body, std::span<const Vec3> corners, const Vec3& along) {
          const Transform there = body.path.at(time, body.shape);
          double most = -INFINITY;
          for (const Vec3& p : corners) most = std::max(most, dot(along, there(p)));
          return most;
        };
        ASSERT_GT(-extent(o2, corners2, -u) - extent(o1, corners1, u), kReserve * (1 - 1e-9));
      }
      proven += until > safe.now() && until < 1;
      forever += until == 1;
    };
    const auto& at1 = o1.shape.sites().mesh().positions;
    const auto& at2 = o2.shape.sites().mesh().positions;
    expect_free(o1.box(), at1, o2.box(), at2, normalized(safe.place(1, {}) - safe.place(0, {})));
    for (std::uint32_t a = 0; a < 4; ++a)
      for (std::uint32_t b = 0; b < 4; ++b) {
        const PointPair points = closest_points(o1.corners(a, safe.now()), o2.corners(b, safe.now()));
        const Vec3 u = normalized(points.point2 - points.point1), about = normalized(u + vector(0.1));
        const std::span corners1 = std::span(at1).subspan(3 * a, 3),
                        corners2 = std::span(at2).subspan(3 * b, 3);
        for (const Vec3& along : {u, about}) {
          expect_free(o1.face(a), corners1, o2.face(b), corners2, along);
          expect_free(o1.box(), at1, o2.face(b), corners2, along);
          expect_free(o1.face(a), corners1, o2.box(), at2, along);
        }
      }
  }
  EXPECT_GT(proven, 1000);
  EXPECT_GT(forever, 500);
}

// Nothing is proven along no direction, of what overlaps, and of bodies that meet, as fast as coordinates
// permit.
TEST(SafeTime, OfNothingProven) {
  Moving o1(test::cube(), {}), o2(test::cube(), {.to = Transform::translation({1, 0, 0})});
  SafeTime safe(o1.motion, o2.motion, 1e-3);
  safe.set_now(0.25);
  for (const Vec3& u : {Vec3{}, Vec3{1, 0, 0}, Vec3{NAN, 0, 0}})
    EXPECT_EQ(safe.until(o1.face(0), o2.face(0), u), 0.25);
  Moving far(test::cube(),
             {.from = Transform::translation({9e36, 0, 0}), .to = Transform::translation({-9e36, 0, 0})});
  const SafeTime huge(o1.motion, far.motion, 1e-3);
  EXPECT_LT(huge.until(o1.face(0), far.face(0), {1, 0, 0}), 0.5);
  EXPECT_LT(huge.until(o1.face(0), far.face(0), normalized({1, 1, 0})), 0.5);
}

}  // namespace
}  // namespace sdm::motion

// Parts of moving bodies are apart until the time that was proven, by their extents at many times before.
#include "proximity/motion/safe_time.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "support/shapes.h"

namespace sdm::motion {
namespace {

// A soup of one body, in any pose, with its box and its faces as parts.
struct Moving {
  Shape shape;
  Motion path;
  DividedMotion motion;

  Moving(const Mesh& mesh, const Motion& p) : shape(mesh), path(p), motion(path, shape) {}

  [[nodiscard]] Part face(std::uint32_t index) const {
    Part part{.points = 3};
    const Mesh& mesh = shape.sites().mesh();
    for (int i = 0; i < 3; ++i) {
      part.point[i] = mesh.positions[mesh.triangles[index][i]] - motion.middle();
      part.radius[i] = motion.scale() * norm(cross(part.point[i], motion.mesh_axis()));
    }
    return part;
  }
  [[nodiscard]] static Part box_of(const Part& face, const DividedMotion& motion) {
    Box box;
    for (const Vec3& p : face.point) extend(box, p);
    Part part;
    part.point[0] = centre(box), part.half = 0.5 * (box.hi - box.lo);
    part.radius[0] = motion.scale() * (norm(cross(part.point[0], motion.mesh_axis())) + norm(part.half));
    return part;
  }
  [[nodiscard]] Corners corners(std::uint32_t index, double time) const {
    const Mesh& mesh = shape.sites().mesh();
    const Transform pose = path.at(time, shape);
    Corners at;
    for (int i = 0; i < 3; ++i) at[i] = pose(mesh.positions[mesh.triangles[index][i]]);
    return at;
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
      if (i % 5 == 2) {  // in place
        const Vec3 size = vector(1);
        motion.to = motion.from * Transform::rotation(180 * size);
      }
      return motion;
    };
    const Mesh mesh1 = test::soup(4, random), mesh2 = test::soup(4, random);
    const Moving o1(mesh1, path()), o2(mesh2, path());
    SafeTime safe(o1.motion, o2.motion, kReserve);
    safe.set_now(i % 3 == 0 ? 0 : fraction(random));
    for (std::uint32_t a = 0; a < 4; ++a)
      for (std::uint32_t b = 0; b < 4; ++b) {
        const Part face1 = o1.face(a), face2 = o2.face(b);
        const PointPair points = closest_points(o1.corners(a, safe.now()), o2.corners(b, safe.now()));
        Vec3 u = normalized(points.point2 - points.point1);
        for (int k = 0; k < 3; ++k) {
          const double until = std::min(
              1.0, k == 1 ? safe.until(Moving::box_of(face1, o1.motion), Moving::box_of(face2, o2.motion), u)
                          : safe.until(face1, face2, u));
          ASSERT_GE(until, safe.now());
          // Of the extents at these times, to rounding.
          for (int step = 0; step <= 20 && until > safe.now(); ++step) {
            const double time = safe.now() + (until - safe.now()) * step / 20;
            double most1 = -INFINITY, least2 = INFINITY;
            for (const Vec3& p : o1.corners(a, time)) most1 = std::max(most1, dot(u, p));
            for (const Vec3& p : o2.corners(b, time)) least2 = std::min(least2, dot(u, p));
            ASSERT_GT(least2 - most1, kReserve * (1 - 1e-9));
          }
          proven += until > safe.now() && until < 1, forever += until == 1;
          if (k == 1) u = normalized(u + vector(0.1));
        }
      }
  }
  EXPECT_GT(proven, 1000);
  EXPECT_GT(forever, 500);
}

// Nothing is proven along no direction, of what overlaps, and by numbers that overflow.
TEST(SafeTime, OfNothingProven) {
  const Moving o1(test::cube(), {}), o2(test::cube(), {.to = Transform::translation({1, 0, 0})});
  SafeTime safe(o1.motion, o2.motion, 1e-3);
  safe.set_now(0.25);
  for (const Vec3& u : {Vec3{}, Vec3{1, 0, 0}, Vec3{NAN, 0, 0}})
    EXPECT_EQ(safe.until(o1.face(0), o2.face(0), u), 0.25);
  const Moving far(test::cube(), {.from = Transform::translation({1e200, 0, 0}),
                                  .to = Transform::translation({-1e200, 0, 0})});
  const SafeTime huge(o1.motion, far.motion, 1e-3);
  EXPECT_LT(huge.until(o1.face(0), far.face(0), {1, 0, 0}), 0.5);
  EXPECT_LT(huge.until(o1.face(0), far.face(0), normalized({1, 1, 0})), 0.5);
}

}  // namespace
}  // namespace sdm::motion

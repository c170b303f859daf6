#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/transform.h>

#include "core/geometry/vec.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void expect_near(const Vec3& a, const Vec3& b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-14);
}

double volume(const Mesh& mesh) {
  double six = 0;
  for (const Triangle& t : mesh.triangles)
    six += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return six / 6;
}

TEST(Transform, ElementaryMaps) {
  const Vec3 p{1, -2, 3};
  EXPECT_EQ(Transform()(p), p);
  EXPECT_EQ(Transform::translation({0.5, -1, 100})(p), (Vec3{1.5, -3, 103}));
  EXPECT_EQ(Transform::scaling(2)(p), (Vec3{2, -4, 6}));
  EXPECT_EQ(Transform::scaling(-2).determinant(), -8);
}

TEST(Transform, RotationsAreRightHandedAndExactForRightAngles) {
  EXPECT_EQ(Transform::rotation({90, 0, 0})(Vec3{0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(Transform::rotation({0, 90, 0})(Vec3{0, 0, 1}), (Vec3{1, 0, 0}));
  EXPECT_EQ(Transform::rotation({0, 0, -270})(Vec3{1, 0, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(Transform::rotation({90, 90, 0})(Vec3{0, 1, 0}), (Vec3{1, 0, 0}));  // y → z → x
  expect_near(Transform::rotation({0, 0, 30})(Vec3{1, 0, 0}), {std::sqrt(3) / 2, 0.5, 0});
}

TEST(Transform, ProductsApplyTheRightFactorFirst) {
  const Transform a = Transform::rotation({10, 20, 30}), b = Transform::translation({1, 2, 3}),
                  c = Transform::scaling(3);
  const Vec3 p{0.3, -0.7, 2};
  expect_near((a * b * c)(p), a(b(c(p))));
  EXPECT_NEAR((a * c).determinant(), 27, 1e-13);
  EXPECT_EQ((a * b).rows[3], (std::array<double, 4>{0, 0, 0, 1}));
}

TEST(Transform, FitMakesTheLongestSideOneAndCentresIt) {
  Mesh mesh = test::torus(16, 12);
  for (Vec3& p : mesh.positions) p = {7 * p[0] + 5, 3 * p[1] - 8, p[2] + 40};
  mesh.positions.push_back({1e6, 1e6, 1e6});  // of no face
  transform(mesh, fit_to_unit(mesh));
  const Box box = bounds(mesh);
  expect_near(centre(box), {0, 0, 0});
  EXPECT_NEAR(box.hi[0] - box.lo[0], 1, 1e-14);
  EXPECT_LT(box.hi[1] - box.lo[1], 1);
}

TEST(Transform, FitNeedsAnExtent) {
  const Mesh mesh{{{1, 1, 1}}, {{0, 0, 0}}, {}};
  EXPECT_THAT([&] { static_cast<void>(fit_to_unit(mesh)); }, ThrowsMessage<Error>(HasSubstr("extent")));
}

TEST(Transform, ReflectionsKeepTheOrientation) {
  Mesh mesh = test::torus(16, 12);
  const double before = volume(mesh);
  transform(mesh, Transform::scaling(-2));
  EXPECT_NEAR(volume(mesh), 8 * before, 1e-12 * before);
}

TEST(Transform, RejectedOverflowChangesNothing) {
  Mesh mesh = test::tetrahedron();
  mesh.positions[3] = {0, 0, 1e200};
  const std::vector<Vec3> before = mesh.positions;
  EXPECT_THROW(transform(mesh, Transform::scaling(-1e200)), Error);
  EXPECT_EQ(mesh.positions, before);
}

}  // namespace
}  // namespace sdm

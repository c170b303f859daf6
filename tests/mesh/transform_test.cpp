#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/mesh_edit.h>

#include <cmath>
#include <random>

#include "geometry/vec.h"
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

TEST(Transform, InversesLeadBack) {
  const Transform pose = Transform::translation({3, -2, 1}) * Transform::rotation({20, -70, 130});
  Transform skewed = pose * Transform::scaling(0.01);
  skewed.rows[0][1] += 0.5;
  skewed.rows[2][0] = -skewed.rows[2][0];
  for (const Transform& map : {Transform(), pose, skewed, Transform::scaling(-4)})
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 2, 3}, Vec3{-7, 0.5, 2}})
      for (const Vec3& back : {map.inverse()(map(p)), map(map.inverse()(p))})
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], p[k], 1e-11);
  EXPECT_EQ(Transform::translation({3, -2, 1}).inverse().rows, Transform::translation({-3, 2, -1}).rows);
  Transform flat;
  flat.rows[1] = flat.rows[0];
  EXPECT_THROW((void)flat.inverse(), Error);
  EXPECT_THROW((void)Transform::scaling(0).inverse(), Error);
  EXPECT_THROW((void)Transform::scaling(std::nan("")).inverse(), Error);
}

TEST(Transform, FitMakesTheLongestSideOneAndCentresIt) {
  Mesh mesh = test::torus(16, 12);
  for (Vec3& p : mesh.positions) p = {7 * p[0] + 5, 3 * p[1] - 8, p[2] + 40};
  mesh.positions.push_back({1e6, 1e6, 1e6});  // of no face
  transform(mesh, fit_to_unit(mesh));
  const Box box = bounds(mesh);
  expect_near(centre(box), {0, 0, 0});
  EXPECT_NEAR(box.upper[0] - box.lower[0], 1, 1e-14);
  EXPECT_LT(box.upper[1] - box.lower[1], 1);
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

void expect_normal(const Transform& map, const Vec3& n, const Vec3& expected) {
  expect_near(map.normal(n), normalized(expected));
}

TEST(Transform, NormalsStayPerpendicularAndOutside) {
  Transform mirror, stretched, shear;
  mirror.rows[0][0] = -1;
  mirror.rows[0][3] = 7;  // no part of the linear map
  stretched.rows[0][0] = 2;
  shear.rows[0][1] = 1;  // x + y
  expect_normal({}, {0, 0, 4}, {0, 0, 1});
  expect_normal(mirror, {1, 1, 0}, {-1, 1, 0});
  expect_normal(mirror, {0, 0, 1}, {0, 0, 1});
  expect_normal(Transform::scaling(-3), {1, 2, 3}, {-1, -2, -3});
  expect_normal(stretched, {1, 1, 0}, {0.5, 1, 0});
  expect_normal(shear, {1, 0, 0}, {1, -1, 0});
  expect_normal(shear, {0, 1, 0}, {0, 1, 0});
  expect_normal(Transform::rotation({0, 90, 0}), {0, 0, 1}, {1, 0, 0});
}

TEST(Transform, NormalsOfSingularMapsAreZero) {
  Transform flat, twice;
  flat.rows[2][2] = 0;
  twice.rows = {{{1, 2, 3, 0}, {2, 4, 6, 0}, {0.1, 0.7, 0.3, 0}, {0, 0, 0, 1}}};
  for (const Transform& map : {flat, twice, Transform::scaling(0)}) {
    EXPECT_EQ(map.orientation(), 0);
    EXPECT_EQ(map.normal({0.3, 0.4, 0.5}), Vec3{});
  }
  EXPECT_EQ(Transform().normal({}), Vec3{});
  EXPECT_EQ(Transform().normal({0, NAN, 1}), Vec3{});
}

// Regression: the determinant of a tiny reflection is 0 in double precision.
TEST(Transform, ReflectionsOfAnyScaleAreSeen) {
  for (const double scale : {1e-150, 1e-3, 1e120}) {
    EXPECT_EQ(Transform::scaling(-scale).orientation(), -1);
    EXPECT_EQ(Transform::scaling(scale).orientation(), 1);
    expect_normal(Transform::scaling(-scale), {1, 2, 3}, {-1, -2, -3});
    Mesh mesh = test::tetrahedron();
    const Triangle before = mesh.triangles[0];
    transform(mesh, Transform::scaling(-scale));
    EXPECT_EQ(mesh.triangles[0], (Triangle{before[0], before[2], before[1]}));
  }
  Transform uneven;
  uneven.rows[0][0] = uneven.rows[1][1] = 1e-200;
  expect_normal(uneven, {0, 0, 1}, {0, 0, 1});
}

// Of the faces of a mesh, under any map.
TEST(Transform, NormalsAreThoseOfTheMappedMesh) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> entry(-1, 1);
  const Mesh mesh = test::torus(8, 6);
  const auto face_normal = [](const Mesh& m, const Triangle& t) {
    return normalized(cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]));
  };
  for (int i = 0; i < 50; ++i) {
    Transform map;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) map.rows[r][c] = entry(random);
    if (std::abs(map.determinant()) < 0.05) continue;
    Mesh moved = mesh;
    transform(moved, map);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
      const Vec3 expected = face_normal(moved, moved.triangles[f]);
      EXPECT_LT(norm(map.normal(face_normal(mesh, mesh.triangles[f])) - expected), 1e-9);
    }
  }
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

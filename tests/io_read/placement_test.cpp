#include <gmock/gmock.h>
#include <sdm/error.h>

#include <fstream>

#include "geometry/vec.h"
#include "io/mesh/placement.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::io {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// The image of a point.
Vec3 moved(const Vec3& p, const char* steps) {
  Mesh mesh{{p}, {}, {}};
  place(mesh, parse_placement(steps));
  return mesh.positions[0];
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-15);
}

TEST(Placement, Translate) {
  EXPECT_EQ(moved({1, 2, 3}, "translate:0.5:-1:1e2"), (Vec3{1.5, 1, 103}));
}

TEST(Placement, ScaleIsAboutTheOrigin) {
  EXPECT_EQ(moved({1, -2, 3}, "scale:2"), (Vec3{2, -4, 6}));
}

TEST(Placement, RotationsAreRightHanded) {
  EXPECT_EQ(moved({0, 1, 0}, "rotate:90:0:0"), (Vec3{0, 0, 1}));
  EXPECT_EQ(moved({0, 0, 1}, "rotate:0:90:0"), (Vec3{1, 0, 0}));
  EXPECT_EQ(moved({1, 0, 0}, "rotate:0:0:90"), (Vec3{0, 1, 0}));
  EXPECT_EQ(moved({1, 0, 0}, "rotate:0:0:-270"), (Vec3{0, 1, 0}));
  EXPECT_EQ(moved({1, 2, 3}, "rotate:0:0:180"), (Vec3{-1, -2, 3}));
  expect_near(moved({1, 0, 0}, "rotate:0:0:30"), {std::sqrt(3) / 2, 0.5, 0});
}

TEST(Placement, RotatesAboutXThenYThenZ) {
  const Vec3 p{1, 2, 3};
  expect_near(moved(p, "rotate:10:20:30"), moved(p, "rotate:10:0:0,rotate:0:20:0,rotate:0:0:30"));
  EXPECT_EQ(moved({0, 1, 0}, "rotate:90:90:0"), (Vec3{1, 0, 0}));  // y → z → x
}

TEST(Placement, StepsAreAppliedInOrder) {
  EXPECT_EQ(moved({1, 0, 0}, "scale:2,translate:1:0:0"), (Vec3{3, 0, 0}));
  EXPECT_EQ(moved({1, 0, 0}, "translate:1:0:0,scale:2"), (Vec3{4, 0, 0}));
  EXPECT_EQ(moved({1, 0, 0}, ""), (Vec3{1, 0, 0}));
}

TEST(Placement, FitMakesTheLongestSideOneAndCentresIt) {
  Mesh mesh = test::torus(16, 12);
  for (Vec3& p : mesh.positions) p = {7 * p[0] + 5, 3 * p[1] - 8, p[2] + 40};
  mesh.positions.push_back({1e6, 1e6, 1e6});  // of no face
  place(mesh, parse_placement("fit"));
  const Box box = bounds(mesh);
  expect_near(centre(box), {0, 0, 0});
  EXPECT_NEAR(box.upper[0] - box.lower[0], 1, 1e-15);
  EXPECT_LT(box.upper[1] - box.lower[1], 1);
}

TEST(Placement, MirrorImagesKeepTheirOrientation) {
  Mesh mesh = test::torus(16, 12);
  const auto outward_volume = [](const Mesh& m) {
    double six = 0;
    for (const Triangle& t : m.triangles)
      six += dot(m.positions[t[0]], cross(m.positions[t[1]], m.positions[t[2]]));
    return six / 6;
  };
  const double volume = outward_volume(mesh);
  place(mesh, parse_placement("scale:-2"));
  EXPECT_NEAR(outward_volume(mesh), 8 * volume, 1e-12 * volume);
}

TEST(Placement, MatricesOfFiles) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "mirror.txt";
  std::ofstream(file) << "-2 0 0 1\n0 2 0 0\n0 0 2 3\n0 0 0 1\n";
  const auto steps = parse_placement("translate:1:0:0,matrix:" + file);
  Mesh mesh = test::tetrahedron();
  place(mesh, steps);
  EXPECT_EQ(mesh.positions[0], (Vec3{-1, 0, 3}));
  EXPECT_EQ(mesh.triangles[0],
            (Triangle{test::tetrahedron().triangles[0][0], test::tetrahedron().triangles[0][2],
                      test::tetrahedron().triangles[0][1]}));
  std::filesystem::remove(file);
  EXPECT_THROW(place(mesh, steps), Error);
  std::ofstream(file) << "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n";
  const auto resolved = without_fit(mesh, steps);
  std::filesystem::remove(file);
  std::vector<Vec3> points{{1, 1, 1}};
  place(points, resolved);
  EXPECT_EQ(points[0], (Vec3{3, 3, 4}));
}

TEST(Placement, RejectsOverflow) {
  Mesh mesh = test::tetrahedron();
  EXPECT_THROW(place(mesh, parse_placement("scale:1e300,scale:1e300")), Error);
}

TEST(Placement, FitNeedsAnExtent) {
  Mesh mesh{{{1, 1, 1}}, {{0, 0, 0}}, {}};
  EXPECT_THAT([&] { place(mesh, parse_placement("fit")); }, ThrowsMessage<Error>(HasSubstr("extent")));
}

TEST(ParsePlacement, ReadsAllSteps) {
  const auto steps = parse_placement("fit,scale:2,rotate:1:2:3,translate:0.8:-0:0,matrix:a:b.txt");
  ASSERT_EQ(steps.size(), 5u);
  EXPECT_EQ(steps[4].file, "a:b.txt");
  EXPECT_EQ(steps[0].kind, PlacementStep::Kind::fit);
  EXPECT_EQ(steps[1].value[0], 2);
  EXPECT_EQ(steps[2].value, (Vec3{1, 2, 3}));
  EXPECT_EQ(steps[3].kind, PlacementStep::Kind::translate);
}

// Frames of a sequence are placed as the first, wherever they are.
TEST(Placement, WithoutFitMovesOtherPointsTheSameWay) {
  Mesh mesh = test::tetrahedron();
  place(mesh, parse_placement("scale:3,translate:7:8:9"));
  const auto steps = parse_placement("rotate:10:20:30,fit,scale:-2,fit,translate:1:2:3");
  const auto resolved = without_fit(mesh, steps);
  for (const PlacementStep& step : resolved) EXPECT_NE(step.kind, PlacementStep::Kind::fit);
  Mesh expected = mesh;
  place(expected, steps);
  std::vector<Vec3> points = mesh.positions;
  points.push_back(0.5 * (points[1] + points[2]));
  place(points, resolved);
  for (std::size_t i = 0; i < 4; ++i) expect_near(points[i], expected.positions[i]);
  expect_near(points[4], 0.5 * (expected.positions[1] + expected.positions[2]));
  // Mirror images flip the faces of a mesh, too.
  Mesh again = mesh;
  place(again, resolved);
  EXPECT_EQ(again.triangles, expected.triangles);
  EXPECT_THROW(place(points, parse_placement("fit")), Error);
}

TEST(ParsePlacement, ErrorNamesTheInvalidStep) {
  const auto expect_refused = [](const char* text, const char* step) {
    EXPECT_THAT([&] { static_cast<void>(parse_placement(text)); }, ThrowsMessage<Error>(HasSubstr(step)))
        << text;
  };
  expect_refused("fit,shear:1", "'shear:1'");
  expect_refused("scale", "'scale'");
  expect_refused("scale:", "'scale:'");
  expect_refused("scale:0", "'scale:0'");
  expect_refused("scale:2x", "'2x'");
  expect_refused("scale:nan", "'nan'");
  expect_refused("scale:inf", "'inf'");
  expect_refused("scale:1:2", "'scale:1:2'");
  expect_refused("rotate:1:2", "'rotate:1:2'");
  expect_refused("translate:1:2:3:", "'translate:1:2:3:'");
  expect_refused("fit:1", "'fit:1'");
  expect_refused("fit,", "''");
  expect_refused(",fit", "''");
  expect_refused(" fit", "' fit'");
  expect_refused("matrix", "'matrix'");
  expect_refused("matrix:", "'matrix:'");
}

}  // namespace
}  // namespace sdm::io

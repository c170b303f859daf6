#include "scenes/made_scan.h"

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>

#include "geometry/vec.h"
#include "scenes/divide_edges.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using namespace scenes;

TEST(DivideEdges, KeepsTheShape) {
  const Mesh part = load("fandisk.off");
  const MeshInfo before = inspect(part);
  for (const std::size_t triangles : {20000u, 60000u}) {
    const Mesh fine = divide_edges(part, triangles);
    const MeshInfo after = inspect(fine);
    EXPECT_NEAR(after.area, before.area, 1e-9 * before.area);
    EXPECT_TRUE(after.closed && after.oriented && after.manifold);
    EXPECT_LE(after.triangles, triangles);
    EXPECT_GT(after.triangles, 0.6 * static_cast<double>(triangles));
    EXPECT_EQ(after.duplicate_faces + after.degenerate_faces + after.unused_vertices, 0u);
  }
}

TEST(DivideEdges, MakesTrianglesOfAboutOneSize) {
  const Mesh fine = divide_edges(cube(), 5000);
  double shortest = 1, longest = 0;
  for (const Triangle& t : fine.triangles)
    for (int k = 0; k < 3; ++k) {
      const double length = norm(fine.positions[t[k]] - fine.positions[t[(k + 1) % 3]]);
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
  EXPECT_LT(longest, 3 * shortest);
}

TEST(MadeScan, IsThePartWithWhatIsSaidAboutIt) {
  const Mesh part = load("fandisk.off");
  const MadeScan scan = make_scan(part, {.triangles = 10000});
  const Box box = bounds(part);
  EXPECT_DOUBLE_EQ(scan.size, diagonal(box));
  EXPECT_NEAR(scan.missing, 0.3, 0.01);
  EXPECT_NEAR(inspect(scan.mesh).area, 0.7 * inspect(part).area, 0.05 * inspect(part).area);
  EXPECT_NEAR(norm(scan.placement(centre(box)) - centre(box)), 0.02 * scan.size, 1e-12);
  EXPECT_NEAR(scan.placement.determinant(), 1, 1e-12);
  const double trace = scan.placement.rows[0][0] + scan.placement.rows[1][1] + scan.placement.rows[2][2];
  EXPECT_NEAR(std::acos((trace - 1) / 2) * 180 / M_PI, 2, 1e-6);

  // Moved back, its vertices are as far from the part as noise and dent say.
  const Transform& m = scan.placement;
  std::vector<Vec3> points = scan.mesh.positions;
  for (Vec3& p : points) {
    const Vec3 q{p[0] - m.rows[0][3], p[1] - m.rows[1][3], p[2] - m.rows[2][3]};
    for (int k = 0; k < 3; ++k) p[k] = m.rows[0][k] * q[0] + m.rows[1][k] * q[1] + m.rows[2][k] * q[2];
  }
  const Sites sites(part);
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  double squares = 0, deepest = 0;
  std::size_t outside = 0;
  Vec3 at{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = closest[i].distance;
    if (norm(points[i] - scan.dent_place) < 1.05 * scan.dent_radius) {
      if (d > deepest) {
        deepest = d;
        at = points[i];
      }
    } else {
      squares += d * d;
      ++outside;
      EXPECT_LT(d, 5 * scan.noise);
    }
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(outside)), scan.noise, 0.1 * scan.noise);
  EXPECT_NEAR(deepest, scan.dent_depth, 4 * scan.noise);
  EXPECT_LT(norm(at - scan.dent_place), 0.4 * scan.dent_radius);
}

TEST(MadeScan, IsTheSameOnEveryRun) {
  const Mesh part = load("fandisk.off");
  EXPECT_EQ(make_scan(part, {.triangles = 5000}).mesh.positions,
            make_scan(part, {.triangles = 5000}).mesh.positions);
}

TEST(MadeScan, NeedsAFlatPlace) {
  EXPECT_THROW((void)make_scan(sphere(5), {.triangles = 50000}), Error);
}

}  // namespace
}  // namespace sdm::test

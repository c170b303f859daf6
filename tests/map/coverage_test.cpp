// Where O2 is covered, as pictures show it.
#include <gtest/gtest.h>
#include <sdm/doubts.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "support/shapes.h"

namespace sdm::test {
namespace {

double area(const std::array<Vec3, 3>& t) {
  return 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
}

std::array<Vec3, 3> corners_of_face(const Mesh& mesh, std::uint32_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

/// The pieces of a face are the face, and the shares add up to the value.
void expect_sums(const Mesh& o2, const CoverageMap& map) {
  ASSERT_EQ(map.of_face.size(), o2.triangles.size());
  std::vector<double> pieces(o2.triangles.size()), covered(pieces.size());
  std::uint32_t last = 0;
  for (const CoveragePiece& p : map.pieces) {
    EXPECT_GE(p.face, last) << "by face";
    last = p.face;
    pieces[p.face] += area(p.corners);
    if (p.covered) covered[p.face] += area(p.corners);
  }
  double all = 0, share = 0;
  for (std::uint32_t f = 0; f < o2.triangles.size(); ++f) {
    const double whole = area(corners_of_face(o2, f));
    if (!(whole > 0)) continue;
    all += whole;
    share += whole * map.of_face[f];
    if (pieces[f] > 0) {
      EXPECT_NEAR(pieces[f], whole, 1e-12 * whole);
      EXPECT_NEAR(map.of_face[f], covered[f] / whole, 1e-6);
    } else {
      EXPECT_TRUE(map.of_face[f] == 0 || map.of_face[f] == 1);
    }
  }
  EXPECT_NEAR(share / all, map.value, 1e-6);
}

TEST(CoverageMap, SumsUpToTheCoverage) {
  const Mesh o2 = joined(sphere(2), cube(0.3));
  const Sites measured(moved(sphere(2), {0.3, 0, 0}));
  for (const double reach : {0.05, 0.2, 1.0}) {
    const CoverageMap map = coverage_map(o2, measured, reach);
    const Coverage same = coverage(o2, measured, reach);
    EXPECT_EQ(map.value, same.value);
    EXPECT_EQ(map.lower, same.lower);
    EXPECT_EQ(map.upper, same.upper);
    expect_sums(o2, map);
  }
}

// Of the square up to x = 1, that up to 0.1 is covered.
TEST(CoverageMap, ShowsTheBorder) {
  Mesh half = square(2, 0);
  for (Vec3& p : half.positions) p[0] = 0.5 * p[0] - 0.5;
  Mesh o2 = square(2, 0);
  o2.triangles.push_back({0, 1, 1});
  const CoverageMap map = coverage_map(o2, Sites(half), 0.1);
  expect_sums(o2, map);
  EXPECT_TRUE(std::isnan(map.of_face[2])) << "a face without area";
  EXPECT_GT(map.pieces.size(), 100U);
  for (const CoveragePiece& p : map.pieces) {
    const double x = (p.corners[0][0] + p.corners[1][0] + p.corners[2][0]) / 3;
    EXPECT_EQ(p.covered, x <= 0.1) << x;
  }
  // By points, which are apart.
  const std::vector<Vec3> points{{-1, 0, 0}, {0, 0, 0}};
  const CoverageMap by_points = coverage_map(o2, points, 0.5);
  EXPECT_EQ(by_points.value, coverage(o2, points, 0.5).value);
  expect_sums(o2, by_points);
}

}  // namespace
}  // namespace sdm::test

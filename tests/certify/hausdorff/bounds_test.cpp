// The bounds that the search for the Hausdorff distance consists of.
#include <gtest/gtest.h>
#include <sdm/sites.h>

#include <random>

#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/part.h"
#include "geometry/vec.h"
#include "support/hausdorff_oracle.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::hausdorff {
namespace {

Corners random_triangle(std::mt19937& random, int kind) {
  std::uniform_real_distribution<double> u(-1, 1);
  Corners t;
  for (Vec3& p : t) p = {u(random), u(random), u(random)};
  const double s = u(random);
  if (kind == 1) t[2] = t[0] + s * (t[1] - t[0]);                         // almost a segment
  if (kind == 2) t[2] = t[0] + s * (t[1] - t[0]) + 1e-9 * Vec3{1, 2, 3};  // a needle
  if (kind == 3) t[1] = t[0];                                             // a segment
  if (kind == 4) t[1] = t[2] = t[0];                                      // a point
  if (kind == 5) {
    t[1] = t[0] + 1e-6 * (t[1] - t[0]);
    t[2] = t[0] + 1e-6 * (t[2] - t[0]);
  }
  return t;
}

TEST(FaceDistance, BoundsContainTheDistance) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 6000; ++i) {
    const Corners t = random_triangle(random, i % 6);
    Vec3 p{2 * u(random), 2 * u(random), 2 * u(random)};
    if (i % 7 == 0) p = t[i % 3];
    if (i % 7 == 1) p = 0.25 * t[0] + 0.5 * t[1] + 0.25 * t[2];
    if (i % 7 == 2) p = t[0] + 1e-9 * p;
    const double truth = oracle::exact_distance(p, t);
    const FaceDistance found = face_distance(p, t);
    const double rounding = 1e-15 * truth;  // of the oracle, to double
    ASSERT_LE(found.lower, truth + rounding) << i;
    ASSERT_GE(found.upper, truth - rounding) << i;
    ASSERT_LE(found.upper - truth, 1e-13) << i;
    const bool needle = i % 6 == 2, close = truth < 1e-4;
    ASSERT_LE(found.upper - found.lower, needle ? 1e-5 : close ? 3e-8 : 1e-11) << i;
    ASSERT_EQ(found.upper, upper_face_distance(p, t));
    ASSERT_LE(norm(found.point - p), found.upper * (1 + 1e-15) + 1e-15);
    if (i % 7 == 0) {
      ASSERT_EQ(found.upper, 0);
    }
  }
}

TEST(NearestFace, IsTheNearest) {
  std::mt19937 random(3);
  for (const Mesh& mesh : {test::sphere(2), test::degenerate_soup(60, 5), test::needles(1e-6)}) {
    const Sites sites(mesh);
    const auto& data = internals(sites);
    for (int i = 0; i < 300; ++i) {
      Vec3 p = test::random_point(bounds(mesh), random);
      if (i % 3 == 0) p = 1e3 * p;
      const double truth = oracle::brute_force(mesh, p),
                   rounding = 1e-14 * (norm(p) + diagonal(bounds(mesh)));
      const std::uint32_t start = data.tree.items[random() % data.tree.items.size()];
      const NearestFace found = nearest_face(data, p, start);
      EXPECT_LE(found.lower, truth + rounding);
      EXPECT_NEAR(found.upper, truth, rounding);
      EXPECT_NEAR(norm(found.point - p), truth, rounding);
    }
  }
}

// Random points of the part are no farther than its bound from the nearest of the faces, and so are the
// pieces; the bound is not above that of the best single face.
TEST(Part, BoundsContainAllDistances) {
  std::mt19937 random(6);
  const Mesh mesh = test::soup(40, random);
  const Sites sites(mesh);
  const auto& b = internals(sites);
  std::exponential_distribution<double> weight;
  for (int trial = 0; trial < 300; ++trial) {
    FacePart part;
    part.at = random_triangle(random, trial % 6);
    for (int k = 0; k < 1 + trial % 9; ++k) {
      part.add(b, b.tree.items[random() % b.tree.items.size()], 0);
      if (k + 1 < trial % 9 && part.count == FacePart::kMostFaces) part.bound();
    }
    part.bound();
    const auto nearest = [&](const Vec3& p) {
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k < part.count; ++k)
        least = std::min(least, upper_face_distance(p, corners_of(mesh, part.b_faces[k])));
      return least;
    };
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < part.count; ++k)
      best = std::min(best, std::max({part.distances[k][0], part.distances[k][1], part.distances[k][2]}));
    ASSERT_LE(part.upper, best * (1 + 1e-14));
    const Pieces pieces = divide(part, b, 1e-9);
    ASSERT_GE(pieces.count, 2);
    double most = 0;
    for (int i = 0; i < pieces.count; ++i) most = std::max(most, pieces.part[i].upper);
    for (int i = 0; i < 60; ++i) {
      Vec3 w{weight(random), weight(random), weight(random)};
      if (i < 3) {
        w = {};
        w[i] = 1;
      }
      w = (1 / (w[0] + w[1] + w[2])) * w;
      const double d = nearest(w[0] * part.at[0] + w[1] * part.at[1] + w[2] * part.at[2]);
      ASSERT_LE(d, part.upper + 1e-14);
      ASSERT_LE(d, most + 1e-14) << "the pieces make up the part";
    }
  }
}

// Where distances are linear, the bound is attained at highest_point().
TEST(Part, BoundIsTightForPlanes) {
  Mesh planes;  // three large triangles
  for (const Vec3& n : {Vec3{0, 0, 1}, Vec3{0, 0.8, -0.6}, Vec3{0.8, -0.36, -0.48}}) {
    const Vec3 u = normalized(cross(n, Vec3{0.3, 0.5, 0.7})), v = cross(n, u);
    const auto first = static_cast<std::uint32_t>(planes.positions.size());
    for (const Vec3& p : {100.0 * u, -50.0 * u + 90.0 * v, -50.0 * u - 90.0 * v})
      planes.positions.push_back(p - n);
    planes.triangles.push_back({first, first + 1, first + 2});
  }
  const Sites sites(planes);
  std::mt19937 random(8);
  for (int trial = 0; trial < 100; ++trial) {
    FacePart part;
    part.at = random_triangle(random, 0);
    for (Vec3& p : part.at) p = 0.4 * p;  // on the same side of all planes
    for (std::uint32_t f = 0; f < 3; ++f) part.add(internals(sites), f, 0);
    part.bound();
    EXPECT_NEAR(part.upper, oracle::brute_force(planes, part.highest_point()), 1e-12);
  }
}

}  // namespace
}  // namespace sdm::hausdorff

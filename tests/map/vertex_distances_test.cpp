#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/multi_body_query.h>

#include <cmath>

#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsNan;

// Vertices at the origin and the unit vectors; a larger tetrahedron around them.
Mesh around() {
  Mesh mesh = tetrahedron();
  for (Vec3& p : mesh.positions) p = {8 * p[0] - 1, 8 * p[1] - 1, 8 * p[2] - 1};
  return mesh;
}

TEST(DistancesAtVertices, AreSignedLikeTheMap) {
  const Sites sites(around());
  EXPECT_THAT(distances_at_vertices(tetrahedron(), sites), Each(-1));
  EXPECT_THAT(distances_at_vertices(tetrahedron(), sites, {.sign = SignMethod::none}), Each(1));
  EXPECT_THAT(distances_at_vertices(tetrahedron(), sites, {.sign = SignMethod::winding}), Each(-1));
}

TEST(DistancesAtVertices, AreNanBeyondTheMaximum) {
  const Sites sites(square(2, 1));
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 0, -2}}, {{0, 1, 2}}, {}};
  EXPECT_THAT(distances_at_vertices(mesh, sites, {.max_distance = 2}), ElementsAre(1, 1, IsNan()));
}

TEST(DistancesAtVertices, UseTheCpuEngineForGl) {
  std::shared_ptr<const Engine> gl;
  try {
    gl = make_engine("gl");
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  const Sites sites(around());
  EXPECT_EQ(distances_at_vertices(tetrahedron(), sites, {.engine = gl}),
            distances_at_vertices(tetrahedron(), sites));
}

TEST(DistancesAtVertices, RejectASignThatO2DoesNotAllow) {
  const Sites open(square(2, 1));
  EXPECT_THROW(static_cast<void>(distances_at_vertices(tetrahedron(), open, {.sign = SignMethod::exact})),
               Error);
}

TEST(NearestDistancesAtVertices, AreToTheNearestOtherBody) {
  const MultiBodyQuery bodies(std::vector{square(1, 0), square(2, 1), square(2, -3)});
  EXPECT_THAT(nearest_distances_at_vertices(bodies, 0, 10), Each(1));
  EXPECT_THAT(nearest_distances_at_vertices(bodies, 2, 10)[0], std::sqrt(9 + 0.5f));
  EXPECT_THAT(nearest_distances_at_vertices(bodies, 2, 2), Each(IsNan()));
  EXPECT_THROW(static_cast<void>(nearest_distances_at_vertices(bodies, 3, 2)), Error);
}

}  // namespace
}  // namespace sdm::test

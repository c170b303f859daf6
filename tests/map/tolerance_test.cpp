// Verdicts of tolerances, against distances that are known: from one square to another, parallel one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/tolerance.h>
#include <sdm/vertex_distances.h>

#include <cmath>
#include <limits>

#include "support/shapes.h"

namespace sdm::test {
namespace {

/// The lower square's map of the distances to a square that is 1 above it.
struct Tolerance : ::testing::Test {
  Surface surface{square(1, 0), {.resolution = 32}};
  Sites sites{square(2, 1)};
  DistanceMap map = compute_map(surface, sites);
  std::vector<float> at_vertices = distances_at_vertices(surface.mesh(), sites);
};

TEST_F(Tolerance, IsCertifiedWithTheErrorBoundToSpare) {
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0.25, 0, 1.25);
  EXPECT_EQ(verdict.largest, 1);
  EXPECT_EQ(verdict.exceeded_area_fraction, 0);
  EXPECT_TRUE(verdict.within);
  EXPECT_TRUE(verdict.certified);
}

TEST_F(Tolerance, IsNotCertifiedIfTheErrorBoundReachesBeyond) {
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0.26, 0, 1.25);
  EXPECT_TRUE(verdict.within);
  EXPECT_FALSE(verdict.certified);
}

TEST_F(Tolerance, IsCertainlyExceeded) {
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0.25, 0, 0.99);
  EXPECT_FALSE(verdict.within);
  EXPECT_TRUE(verdict.certified);
  EXPECT_EQ(verdict.exceeded_area_fraction, 1);
}

TEST_F(Tolerance, IsExceededByASingleVertexOrSample) {
  std::vector<float> one_vertex = at_vertices;
  one_vertex[2] = -3;
  EXPECT_EQ(check_tolerance(surface, map, one_vertex, 0, 0, 2).largest, 3);
  EXPECT_FALSE(check_tolerance(surface, map, one_vertex, 0, 0, 2).within);
  map.distance[surface.sample_texels()[5]] = -3;
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0, 0, 2);
  EXPECT_FALSE(verdict.within);
  EXPECT_GT(verdict.exceeded_area_fraction, 0);
  EXPECT_LT(verdict.exceeded_area_fraction, 0.1);
}

TEST_F(Tolerance, IsExceededWhereThereIsNoValue) {
  std::vector<float> unknown = at_vertices;
  unknown[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(check_tolerance(surface, map, unknown, 0, 0, 2).within);
  const MapOptions near{.max_distance = 0.5};
  map = compute_map(surface, sites, near);
  EXPECT_FALSE(check_tolerance(surface, map, at_vertices, 0, 0, 2).within);
}

TEST_F(Tolerance, RejectsDistancesOfOtherVertices) {
  at_vertices.pop_back();
  EXPECT_THROW(static_cast<void>(check_tolerance(surface, map, at_vertices, 0, 0, 2)), Error);
}

TEST(EngineAccuracy, IsRelativeToTheDiagonalOfBothMeshes) {
  for (const EngineInfo& engine : engines())
    EXPECT_DOUBLE_EQ(engine_accuracy(engine, square(1, 0), square(2, 1)),
                     engine.relative_error * std::sqrt(4 + 4 + 1));
}

}  // namespace
}  // namespace sdm::test

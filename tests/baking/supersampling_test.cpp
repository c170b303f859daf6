// Several samples a texel.
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/mesh_attributes.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "support/error_of.h"

namespace sdm::test {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

TEST(Supersampling, TexelsAreTheMeansOfTheirSquares) {
  std::vector<float> samples(6 * 4 * 2);  // two components, three texels by two
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<float>(i * i % 23);
  const TexelMeans means = mean_of_samples({6, 2}, 2, samples);
  ASSERT_EQ(means.values.size(), 12u);
  for (std::size_t y = 0; y < 2; ++y)
    for (std::size_t x = 0; x < 3; ++x)
      for (std::size_t k = 0; k < 2; ++k) {
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) sum += samples[((2 * y + i / 2) * 6 + 2 * x + i % 2) * 2 + k];
        EXPECT_FLOAT_EQ(means.values[(y * 3 + x) * 2 + k], static_cast<float>(sum / 4));
        EXPECT_EQ(means.coverage[y * 3 + x], 1);
      }
  EXPECT_EQ(mean_of_samples({6, 1}, 2, samples).values, samples);
}

TEST(Supersampling, SamplesWithoutValuesDoNotCount) {
  const std::vector<float> samples{1, kNothing, kNothing, kNothing, 3, 5, kNothing, kNothing};
  const TexelMeans means = mean_of_samples({4, 2}, 1, samples);
  EXPECT_EQ(means.values[0], 3);
  EXPECT_EQ(means.coverage[0], 0.75f);
  EXPECT_TRUE(std::isnan(means.values[1]));
  EXPECT_EQ(means.coverage[1], 0);
}

TEST(Supersampling, MeansOfDirectionsHaveLengthOne) {
  const float half = std::sqrt(0.5f);
  const std::vector<float> samples{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1};
  const TexelMeans means = mean_of_samples({2, 2}, 3, samples, SampleKind::directions);
  const std::vector<double> expected{1, 1, 2};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(means.values[k], expected[k] / std::sqrt(6.0), 1e-6);
  const std::vector<float> opposite{half, half, 0, -half, -half, 0, kNothing, 0, 0, kNothing, 0, 0};
  const TexelMeans cancelled = mean_of_samples({2, 2}, 3, opposite, SampleKind::directions);
  EXPECT_EQ(std::vector(cancelled.values), (std::vector<float>{half, half, 0}));
}

/// Two squares that meet in the plane x = 0 at this angle, beside each other in the texture.
Mesh folded(double angle) {
  const double c = std::cos(angle / 2), s = std::sin(angle / 2);
  Mesh mesh{.positions = {{0, 0, 0}, {0, 1, 0}, {-s, 0, -c}, {-s, 1, -c}, {s, 0, -c}, {s, 1, -c}},
            .triangles = {{2, 0, 1}, {2, 1, 3}, {0, 4, 5}, {0, 5, 1}},
            .corner_uvs = {}};
  const std::array<Vec2, 6> uv{Vec2{0.51, 0}, {0.51, 1}, {0, 0}, {0, 1}, {1, 0}, {1, 1}};
  for (const Triangle& t : mesh.triangles) mesh.corner_uvs.push_back({uv[t[0]], uv[t[1]], uv[t[2]]});
  return mesh;
}

// Regression: normals in tangent space were averaged over folds of O1, whose sides have other tangents.
TEST(Supersampling, TexelsAtAFoldHaveTheNormalOfTheirSide) {
  for (const std::uint32_t side : {2u, 4u}) {
    const Surface surface(folded(1.2), sample_layout({.kind = AtlasKind::uv, .resolution = 32}, side));
    const MeshAttribute normals = smooth_normals(surface.mesh(), kDrawnCrease);
    // What O2 has is upwards everywhere: in the tangent spaces of the two sides, opposite x.
    std::vector<float> samples;
    for (const std::uint32_t face : surface.texel_faces()) {
      const float x = face < 2 ? 0.8f : -0.8f;
      samples.insert(samples.end(), {x, 0, 0.6f});
    }
    const TexelMeans means = mean_of_samples(surface, side, 3, samples, SampleKind::directions, &normals);
    for (std::size_t texel = 0; texel < 32 * 32; ++texel) {
      const float x =
          texel % 32 < 16 ? 0.8f : -0.8f;  // the fold is at 16.32 texels, before the centre at 16.5
      EXPECT_NEAR(means.values[3 * texel], x, 1e-6) << texel;
      EXPECT_EQ(means.coverage[texel], 1);
    }
    // Numbers of one chart are averaged over the fold, where the surface goes on.
    double least = 1;
    const TexelMeans of_numbers = mean_of_samples(surface, side, 3, samples);
    for (std::size_t texel = 0; texel < 32 * 32; ++texel)
      least = std::min(least, std::abs(double{of_numbers.values[3 * texel]}));
    EXPECT_LT(least, 0.5);
  }
}

// Charts that touch in the texture are parts of the surface that have nothing to do with each other.
TEST(Supersampling, TexelsAreOfOneChart) {
  Mesh mesh = folded(1.2);
  for (std::size_t f = 0; f < 2; ++f)  // with a border between both: other vertices
    for (std::uint32_t& v : mesh.triangles[f]) v += 6;
  const std::vector<Vec3> copy = mesh.positions;
  mesh.positions.insert(mesh.positions.end(), copy.begin(), copy.end());
  const Surface surface(mesh, sample_layout({.kind = AtlasKind::uv, .resolution = 32}, 4));
  ASSERT_EQ(surface.chart_count(), 2u);
  std::vector<float> samples;
  for (const std::uint32_t face : surface.texel_faces()) samples.push_back(face < 2 ? 1 : 5);
  const TexelMeans means = mean_of_samples(surface, 4, 1, samples);
  for (std::size_t texel = 0; texel < 32 * 32; ++texel)
    EXPECT_EQ(means.values[texel], texel % 32 < 16 ? 1 : 5) << texel;
  EXPECT_NE(error_of([&] { return mean_of_samples(surface, 4, 2, samples); }), "");
}

TEST(Supersampling, NumbersAreTheMostFrequentOnes) {
  const std::vector<std::uint32_t> samples{7, 9, 2, kNone, kNone, kNone, 9, 9, 1, kNone, kNone, kNone};
  EXPECT_EQ(most_frequent_samples({6, 2}, samples), (std::vector<std::uint32_t>{9, 1, kNone}));
}

TEST(Supersampling, GridsThatDoNotFitAreRefused) {
  const std::vector<float> samples(12);
  for (const SampleGrid& grid : {SampleGrid{4, 2}, SampleGrid{3, 2}, SampleGrid{0, 1}, SampleGrid{4, 0}})
    EXPECT_NE(error_of([&] { return mean_of_samples(grid, 1, samples); }), "") << grid.resolution;
  EXPECT_EQ(error_of([&] { return mean_of_samples({6, 2}, 1, samples); }), "");
}

TEST(Supersampling, SamplesAreLaidOutInWholeTexels) {
  for (std::uint32_t side = 1; side <= 8; ++side)
    EXPECT_EQ(sample_side(std::int64_t{side} * side), std::optional(side));
  for (const std::int64_t samples : {-1, 0, 2, 5, 63, 65, 81}) EXPECT_EQ(sample_side(samples), std::nullopt);
  const AtlasOptions samples = sample_layout({.resolution = 100, .rows = 50, .gutter = 2}, 3);
  EXPECT_EQ(samples.resolution, 300u);
  EXPECT_EQ(samples.rows, std::optional(150u));
  EXPECT_EQ(samples.gutter, 8u);  // charts in different texels, with two texels between them
  EXPECT_EQ(sample_layout({.resolution = 16, .gutter = UINT32_MAX}, 2).gutter, UINT32_MAX);
  EXPECT_EQ(sample_layout({.resolution = 8}, 1).resolution, 8u);
}

TEST(Supersampling, LayoutsThatNoSurfaceHasAreRefused) {
  EXPECT_NE(error_of([] { return sample_layout({.resolution = 8}, 2); }), "");
  EXPECT_NE(error_of([] { return sample_layout({.resolution = 4097}, 8); }), "");
  EXPECT_NE(error_of([] { return sample_layout({.resolution = 16, .rows = 4097}, 8); }), "");
  EXPECT_EQ(error_of([] { return sample_layout({.resolution = 4096, .rows = 4096}, 8); }), "");
}

}  // namespace
}  // namespace sdm::test

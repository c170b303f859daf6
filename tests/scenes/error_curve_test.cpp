// The relative error of the letters and the bunnies (Fig. 6 of the paper), as reported, against measured
// values: distances from points all over the surface to their nearest samples, by CGAL.
#include <gtest/gtest.h>
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/parallel.h"
#include "scenes/scene.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace sdm::scenes {
namespace {

/// Barycentric coordinates: the corners of a face, points along its edges, and inside.
std::vector<Vec3> places() {
  std::vector<Vec3> weights{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 120; ++i) {
    const double s = i % 4 == 0 ? 1 : std::sqrt(unit(random)), t = unit(random);
    Vec3 w{1 - s, s * (1 - t), s * t};
    std::rotate(w.begin(), w.begin() + i % 3, w.end());
    weights.push_back(w);
  }
  return weights;
}

/// The largest distance of such points to the nearest sample.
double largest_gap(const Surface& surface) {
  static const std::vector<Vec3> weights = places();
  const oracle::CgalPoints samples(surface.sample_points());
  const Mesh& mesh = surface.mesh();
  std::vector<double> gaps(mesh.triangles.size());
  parallel_for(gaps.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (const Vec3& w : weights) {
        const auto& [a, b, c] = mesh.triangles[f];
        const Vec3 p = w[0] * mesh.positions[a] + w[1] * mesh.positions[b] + w[2] * mesh.positions[c];
        gaps[f] = std::max(gaps[f], samples.distance(p));
      }
  });
  return *std::ranges::max_element(gaps);
}

class ErrorCurve : public testing::TestWithParam<SceneKind> {};

TEST_P(ErrorCurve, BoundsTheMeasuredErrorClosely) {
  Scene scene(GetParam(), {.mesh = test::mesh_file("bunny.obj")});
  std::vector<Surface> surfaces;
  std::vector<SamplingBound> bounds;
  std::vector<RelativeError> errors;
  std::vector<double> first, slack;
  for (const Scene::Body& body : scene.bodies()) {
    surfaces.emplace_back(body.mesh, AtlasOptions{.resolution = 512});
    bounds.emplace_back(surfaces.back());
    errors.emplace_back(surfaces.back(), bounds.back());
    first.push_back(largest_gap(surfaces.back()));
  }
  constexpr int kFrames = 150, kStride = 15;
  double most = 1;
  for (int frame = 1; frame <= kFrames; ++frame) {
    scene.advance();
    if (frame % kStride != 0) continue;
    for (std::size_t b = 0; b < surfaces.size(); ++b) {
      SCOPED_TRACE(scene.bodies()[b].name + " in frame " + std::to_string(frame));
      surfaces[b].refit(scene.bodies()[b].mesh.positions);
      bounds[b].refit(surfaces[b]);
      const double reported = errors[b].of(bounds[b]), measured = largest_gap(surfaces[b]) / first[b];
      EXPECT_GE(reported, measured);
      slack.push_back(reported / measured);
      most = std::max(most, measured);
    }
  }
  EXPECT_GT(most, 1.01) << "nothing deforms";
  std::ranges::sort(slack);
  const double median = slack[slack.size() / 2];
  RecordProperty("median_of_reported_over_measured", std::to_string(median));
  EXPECT_LE(median, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Scene, ErrorCurve, testing::Values(SceneKind::letters, SceneKind::bunnies),
                         [](const auto& scene) {
                           return std::string(scene.param == SceneKind::letters ? "Letters" : "Bunnies");
                         });

}  // namespace
}  // namespace sdm::scenes

#include "scenes/level_set.h"

#include <gtest/gtest.h>

#include <numbers>

namespace sdm::scenes {
namespace {

double ball(const Vec3& p) {
  return norm(p) - 1;
}
double ring(const Vec3& p) {
  return std::hypot(std::hypot(p[0], p[1]) - 1, p[2]) - 0.3;
}
constexpr Box kBox{{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}};

double signed_volume(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]));
  return six / 6;
}

TEST(LevelSet, IsAnOutwardOrientedManifoldOfTheExpectedTopology) {
  struct Case {
    double (*field)(const Vec3&);
    int euler;
    double volume;
  };
  constexpr double kPi = std::numbers::pi;
  for (const auto& [field, euler, volume] :
       {Case{ball, 2, 4 * kPi / 3}, Case{ring, 0, 2 * kPi * kPi * 0.09}}) {
    const Mesh mesh = level_set(field, kBox, 0.07);
    const MeshInfo info = inspect(mesh);
    EXPECT_TRUE(info.closed && info.manifold && info.oriented);
    EXPECT_EQ(info.degenerate_faces + info.duplicate_faces + info.unused_vertices, 0u);
    EXPECT_EQ(static_cast<int>(info.vertices + info.triangles) - static_cast<int>(info.edges), euler);
    EXPECT_NEAR(signed_volume(mesh), volume, 0.02 * volume);
  }
}

TEST(LevelSet, ConvergesToTheSurface) {
  double last = 1;
  for (const double spacing : {0.2, 0.1, 0.05}) {
    double worst = 0;
    for (const Vec3& p : level_set(ball, kBox, spacing).positions) worst = std::max(worst, std::abs(ball(p)));
    EXPECT_LT(worst, 0.1 * spacing);
    EXPECT_LT(worst, 0.7 * last);
    last = worst;
  }
}

}  // namespace
}  // namespace sdm::scenes

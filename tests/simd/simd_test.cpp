// Every set of vector instructions that this machine can run gives what the reference engine gives.
#include <gmock/gmock.h>
#include <hwy/targets.h>
#include <sdm/map.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/vec.h"

namespace sdm {
namespace {

Mesh sphere(int rings, double radius, const Vec3& centre) {
  Mesh mesh;
  const int sectors = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double theta = std::numbers::pi * i / rings, phi = 2 * std::numbers::pi * j / sectors;
      mesh.positions.push_back(centre + radius * Vec3{std::sin(theta) * std::cos(phi),
                                                      std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * sectors + j % sectors); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

Mesh soup(std::size_t triangles, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> n;
  Mesh mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const Vec3 middle{n(random), n(random), n(random)};
    for (int k = 0; k < 3; ++k)
      mesh.positions.push_back(middle + size * Vec3{n(random), n(random), 1e-4 * n(random)});
    const auto v = static_cast<std::uint32_t>(3 * i);
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

std::vector<Vec3> cloud(std::size_t count, double spread, const Vec3& centre) {
  std::mt19937 random(11);
  std::normal_distribution<double> n;
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = centre + spread * Vec3{n(random), n(random), n(random)};
  return points;
}

class EveryTarget : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { use(std::int64_t{1} << GetParam()); }
  void TearDown() override { use(0); }  // 0: what the machine has
  static void use(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }

  static void expect_as_reference(const Sites& sites, const std::vector<Vec3>& points) {
    Box scene = bounds(sites.mesh());
    for (const Vec3& p : points) extend(scene, p);
    const auto fast = closest_points(sites, points);
    const auto exact = closest_points(sites, points, {.engine = EngineKind::reference});
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_NE(fast[i].type, SiteType::none);
      worst = std::max(worst, std::abs(fast[i].distance - exact[i].distance));
    }
    EXPECT_LE(worst, 1e-6 * diagonal(scene));
  }
};

TEST_P(EveryTarget, AgreesWithTheReferenceEngine) {
  expect_as_reference(Sites(sphere(40, 1, {})), cloud(20000, 1, {}));
  expect_as_reference(Sites(sphere(40, 1, {})), cloud(1003, 0.2, {30, 0, 0}));
  expect_as_reference(Sites(sphere(12, 1e-3, {1e5, 1e5, 0})), cloud(5000, 1e-3, {1e5, 1e5, 0}));
  expect_as_reference(Sites(soup(3000, 0.2, 1)), cloud(20000, 1, {}));
  expect_as_reference(Sites(soup(1, 1, 2)), cloud(1000, 2, {}));
}

std::vector<int> targets() {
  std::vector<int> bits;
  for (int bit = 0; bit < 63; ++bit)
    if (hwy::SupportedTargets() & HWY_TARGETS & (std::int64_t{1} << bit)) bits.push_back(bit);
  return bits;
}

INSTANTIATE_TEST_SUITE_P(Simd, EveryTarget, testing::ValuesIn(targets()), [](const auto& test) {
  return std::string(hwy::TargetName(std::int64_t{1} << test.param));
});

}  // namespace
}  // namespace sdm

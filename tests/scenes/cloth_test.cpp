#include "scenes/cloth.h"

#include <gtest/gtest.h>
#include <sdm/self_proximity_query.h>

#include "geometry/vec.h"
#include "scenes/box_mesh.h"

namespace sdm::scenes {
namespace {

constexpr double kStep = 1.0 / 1200;

double height_sum(Cloth& cloth) {
  double sum = 0;
  for (const Vec3& p : cloth.positions()) sum += p[2];
  return sum;
}

TEST(Cloth, IsASheet) {
  const MeshInfo info = inspect(Cloth(20, 2).mesh());
  EXPECT_EQ(info.triangles, 2u * 19 * 19);
  EXPECT_TRUE(info.oriented && info.manifold);
  EXPECT_EQ(info.components, 1u);
  EXPECT_EQ(info.boundary_edges, 4u * 19);
  EXPECT_NEAR(info.area, 4, 1e-9);
}

TEST(Cloth, FallsRigidly) {
  Cloth cloth(20, 1);
  for (int i = 0; i < 60; ++i) cloth.step(kStep, {});
  const double t = 60 * kStep;
  for (std::size_t v = 0; v < cloth.positions().size(); ++v)
    EXPECT_LE(norm(cloth.positions()[v] - cloth.mesh().positions[v] - Vec3{0, 0, -0.5 * 9.81 * t * t}), 1e-3);
}

// A sheet that falls edge first onto the floor folds on itself.
struct FoldedCloth : ::testing::Test {
  static constexpr std::uint32_t kSide = 32;
  Cloth cloth{kSide, 1};
  std::vector<Sites> solids;

  FoldedCloth() {
    solids.emplace_back(box_mesh({{-2, -2, -0.2}, {2, 2, 0}}));
    for (Vec3& p : cloth.positions()) p = {p[0], 0.02 * p[1] + 0.02 * p[0], p[1] + 0.55};
  }
};

TEST_F(FoldedCloth, KeepsEdgesDistanceAndEnergyAndComesToRest) {
  const double start = height_sum(cloth);
  std::vector<Vec3> before(cloth.positions().begin(), cloth.positions().end());
  double last_kinetic = 0;
  for (int i = 1; i <= 2400; ++i) {
    cloth.step(kStep, solids);
    if (i % 100 != 0) {
      std::ranges::copy(cloth.positions(), before.begin());
      continue;
    }
    double kinetic = 0;
    for (std::size_t v = 0; v < before.size(); ++v) {
      const Vec3& p = cloth.positions()[v];
      ASSERT_TRUE(finite(p));
      EXPECT_GT(p[2], 0.9 * cloth.thickness());
      kinetic += 0.5 * squared_norm((1 / kStep) * (p - before[v]));
    }
    EXPECT_LT(kinetic + 9.81 * height_sum(cloth), 1.001 * 9.81 * start);
    last_kinetic = kinetic;
    double stretch = 0;
    std::size_t edges = 0;
    for (const Triangle& t : cloth.mesh().triangles)
      for (int k = 0; k < 3; ++k, ++edges) {
        const auto length = [&](std::span<const Vec3> p) { return norm(p[t[(k + 1) % 3]] - p[t[k]]); };
        const double ratio = length(cloth.positions()) / length(cloth.mesh().positions);
        EXPECT_GT(ratio, 0.3);
        EXPECT_LT(ratio, 1.6);
        stretch += ratio;
      }
    EXPECT_NEAR(stretch / static_cast<double>(edges), 1, 0.05);
  }
  EXPECT_LT(last_kinetic, 0.02 * 9.81 * start);

  // Layers rest on each other, one thickness apart.
  std::size_t layers = 0;
  double closest = 1;
  const auto now = cloth.positions();
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (norm(cloth.mesh().positions[i] - cloth.mesh().positions[j]) < 5 * cloth.thickness()) continue;
      closest = std::min(closest, norm(now[i] - now[j]));
      layers += norm(now[i] - now[j]) < 1.3 * cloth.thickness();
    }
  EXPECT_GT(layers, 100u);
  EXPECT_GT(closest, 0.5 * cloth.thickness());

  // Layers intersect nowhere, not even between particles.
  SelfProximityQuery query(cloth.mesh(), {.exclusion = {.geodesic = 2 * cloth.thickness()}});
  query.refit(now);
  ASSERT_TRUE(query.separation());
  EXPECT_GT(query.separation()->value, 0);
  EXPECT_FALSE(query.contacts(1.3 * cloth.thickness()).empty());
}

}  // namespace
}  // namespace sdm::scenes

// The cloth of the scene `tear`: sites and surface follow its edits.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/execution.h>
#include <sdm/surface.h>

#include "geometry/vec.h"
#include "scenes/scene.h"

namespace sdm::scenes {
namespace {

constexpr int kFrames = 70;

TEST(TearScene, ABallTearsTheClothAndFallsThrough) {
  Scene scene(SceneKind::tear);
  const Mesh first = scene.bodies()[0].mesh;
  EXPECT_EQ(first.triangles.size(), 2u * 49 * 49);
  EXPECT_TRUE(scene.bodies()[0].tears && !scene.bodies()[1].tears);
  Mesh mesh = first;
  std::size_t frames_with_tears = 0;
  double lowest = 1;
  for (int frame = 0; frame < kFrames; ++frame) {
    scene.advance();
    const Scene::Body& cloth = scene.bodies()[0];
    frames_with_tears += !cloth.edit.reconnected_faces.empty();
    apply(mesh, cloth.edit);
    mesh.positions = cloth.mesh.positions;
    ASSERT_EQ(mesh.triangles, cloth.mesh.triangles);
    for (const Vec3& p : cloth.mesh.positions) ASSERT_TRUE(finite(p) && p[2] > -0.01);
    lowest = std::min(lowest, bounds(scene.bodies()[1].mesh).upper[2]);
  }
  EXPECT_GT(frames_with_tears, 3u);
  EXPECT_GT(mesh.positions.size(), first.positions.size() + 20);
  EXPECT_LT(lowest, 0.5);  // below the cloth
  const MeshInfo info = inspect(mesh), before = inspect(first);
  EXPECT_GT(info.boundary_edges, before.boundary_edges + 20);
  EXPECT_EQ(info.nonmanifold_edges, 0u);
  EXPECT_TRUE(info.oriented);
  for (std::uint32_t y = 0; y < 50; ++y)  // held at both sides
    EXPECT_EQ(mesh.positions[50 * y], first.positions[50 * y]);
}

TEST(TearScene, SitesAndSurfaceFollow) {
  Scene scene(SceneKind::tear);
  Sites sites(scene.bodies()[0].mesh);
  Surface surface(scene.bodies()[0].mesh, {.resolution = 256});
  const std::vector<std::uint32_t> owners(surface.texel_faces().begin(), surface.texel_faces().end());
  const ClosestPointOptions exact{.engine = make_engine("reference")};
  for (int frame = 0; frame < kFrames; ++frame) {
    scene.advance();
    const Scene::Body &cloth = scene.bodies()[0], &ball = scene.bodies()[1];
    sites.edit(cloth.edit);
    sites.refit(cloth.mesh.positions);
    surface.edit(cloth.edit);
    surface.refit(cloth.mesh.positions);
    // A tear changes no texel.
    ASSERT_TRUE(std::ranges::equal(surface.texel_faces(), owners));
    if (frame % 10 != 9) continue;
    const Sites fresh(cloth.mesh);
    const auto a = closest_points(sites, ball.mesh.positions, exact);
    const auto b = closest_points(fresh, ball.mesh.positions, exact);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].distance, b[i].distance) << frame;
    EXPECT_TRUE(std::ranges::equal(sites.edges(), fresh.edges()));
  }
}

TEST(TearScene, IsBitIdenticalForAnyThreadCount) {
  std::vector<std::vector<Vec3>> results;
  for (const unsigned threads : {1u, 3u}) {
    const ThreadLimit limit(threads);
    Scene scene(SceneKind::tear);
    for (int i = 0; i < 40; ++i) scene.advance();
    results.push_back(scene.bodies()[0].mesh.positions);
  }
  EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace sdm::scenes

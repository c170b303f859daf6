// The agents of the scene `crowd` stay apart and on the ground, and reach the other side.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/multi_body_query.h>

#include "scenes/scene.h"

namespace sdm::scenes {
namespace {

constexpr std::size_t kAgents = 100;

/// The soles of the agents.
std::vector<Vec3> places(const Scene& scene) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < kAgents; ++i) {
    const std::vector<Vec3>& p = scene.bodies()[i].mesh.positions;
    result.push_back(p[p.size() - 2]);  // the centre of the lower cap
  }
  return result;
}

TEST(Crowd, StaysApartAndOnTheGround) {
  Scene scene(SceneKind::crowd);
  ASSERT_EQ(scene.bodies().size(), kAgents + 1);
  std::vector<Mesh> meshes;
  for (std::size_t i = 0; i < kAgents; ++i) {
    ASSERT_TRUE(scene.bodies()[i].moves);
    meshes.push_back(scene.bodies()[i].mesh);
  }
  const Scene::Body& ground = scene.bodies().back();
  ASSERT_FALSE(ground.moves);
  const Sites hills(ground.mesh);
  MultiBodyQuery query(meshes);
  std::vector<std::span<const Vec3>> positions(kAgents);
  std::size_t near = 0;
  for (int frame = 0; frame < 600; ++frame) {
    const std::vector<Vec3> before = places(scene);
    scene.advance();
    const std::vector<Vec3> now = places(scene);
    for (std::size_t i = 0; i < kAgents; ++i) ASSERT_LE(norm(now[i] - before[i]), 2.2 / 60);
    if (frame % 20 != 0) continue;
    for (std::size_t i = 0; i < kAgents; ++i) positions[i] = scene.bodies()[i].mesh.positions;
    query.refit(positions);
    ASSERT_TRUE(query.colliding().empty()) << frame;
    near += query.separations(0.5).size();
    for (const ClosestPoint& closest : closest_points(hills, now)) ASSERT_LE(closest.distance, 0.02);
  }
  EXPECT_GT(near, 500u);  // they do meet
}

TEST(Crowd, ReachesTheOtherSide) {
  Scene scene(SceneKind::crowd);
  const std::vector<Vec3> start = places(scene);
  for (int frame = 0; frame < 1500; ++frame) scene.advance();
  const std::vector<Vec3> end = places(scene);
  std::size_t across = 0;
  for (std::size_t i = 0; i < kAgents; ++i) across += start[i][0] * end[i][0] + start[i][1] * end[i][1] < 0;
  EXPECT_GE(across, 95u);
}

}  // namespace
}  // namespace sdm::scenes

// Bodies have the right size, move, touch, deform and separate, and keep momentum and shape; scenes are
// bit-identical for any number of threads.
#include <gmock/gmock.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/map.h>

#include "geometry/vec.h"
#include "scenes/scene.h"
#include "support/meshes.h"

namespace sdm::scenes {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SceneOptions options() {
  return {.mesh = test::mesh_file("bunny.obj")};
}

void expect_triangles(const Scene& scene, const std::vector<std::pair<std::string, double>>& expected) {
  ASSERT_EQ(scene.bodies().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(scene.bodies()[i].name, expected[i].first);
    EXPECT_NEAR(static_cast<double>(scene.bodies()[i].mesh.triangles.size()), expected[i].second,
                0.005 * expected[i].second);
  }
}

TEST(Scene, BodiesHaveThePapersSizes) {
  expect_triangles(Scene(SceneKind::letters), {{"E", 2100}, {"G", 1600}});
  expect_triangles(Scene(SceneKind::bunnies, options()), {{"left", 2000}, {"right", 2000}});
  expect_triangles(Scene(SceneKind::figure), {{"figure", 17200}, {"box", 12}});
  expect_triangles(Scene(SceneKind::cloth), {{"cloth", 2 * 99 * 99}, {"ball", 2048}, {"floor", 12}});
}

TEST(Scene, IsBitIdenticalForAnyThreadCount) {
  for (const auto& [kind, frames] : {std::pair{SceneKind::letters, 40},
                                     {SceneKind::bunnies, 35},
                                     {SceneKind::figure, 3},
                                     {SceneKind::crowd, 200},
                                     {SceneKind::cloth, 8}}) {
    std::vector<std::vector<Vec3>> results;
    for (const unsigned threads : {1u, 2u, 5u}) {
      const ThreadLimit limit(threads);
      Scene scene(kind, options());
      for (int i = 0; i < frames; ++i) scene.advance();
      results.push_back(scene.bodies()[0].mesh.positions);
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
  }
}

TEST(Scene, BunniesRequireAMesh) {
  EXPECT_THAT([] { Scene(SceneKind::bunnies, {.mesh = "/no/such/bunny.obj"}); },
              ThrowsMessage<Error>(HasSubstr("/no/such/bunny.obj: there is no such file")));
}

double volume(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]));
  return six / 6;
}

/// The least signed distance of the vertices of one body to another.
double clearance(const Mesh& points, const Mesh& solid) {
  const Sites sites(solid);
  const auto closest = closest_points(sites, points.positions);
  const auto is_inside = inside_flags(sites, points.positions, closest, SignMethod::exact);
  double least = 1e9;
  for (std::size_t i = 0; i < closest.size(); ++i)
    least = std::min(least, is_inside[i] ? -closest[i].distance : closest[i].distance);
  return least;
}

/// The shares of edges that are now longer or shorter than at rest by more than a twentieth.
double strained(const Mesh& now, const Mesh& rest) {
  std::size_t count = 0;
  for (const Triangle& t : now.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto length = [&](const Mesh& m) {
        return norm(m.positions[t[(k + 1) % 3]] - m.positions[t[k]]);
      };
      count += std::abs(length(now) / length(rest) - 1) > 0.05;
    }
  return static_cast<double>(count) / static_cast<double>(3 * now.triangles.size());
}

struct Collision : ::testing::TestWithParam<SceneKind> {};

TEST_P(Collision, TouchesDeformsSeparatesAndKeepsMomentumAndShape) {
  Scene scene(GetParam(), options());
  const std::vector<Scene::Body> rest(scene.bodies().begin(), scene.bodies().end());
  for (const Scene::Body& body : rest) EXPECT_TRUE(inspect(body.mesh).closed);
  double first_energy = 0, least = 1, most_strained = 0;
  Vec3 first_momentum{};
  for (int frame = 1; frame <= 110; ++frame) {
    const std::vector<Scene::Body> before(scene.bodies().begin(), scene.bodies().end());
    scene.advance();
    double energy = 0;
    Vec3 momentum{};
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t v = 0; v < before[i].mesh.positions.size(); ++v) {
        const Vec3 velocity =
            (1 / scene.time_step()) * (scene.bodies()[i].mesh.positions[v] - before[i].mesh.positions[v]);
        ASSERT_TRUE(finite(velocity));
        energy += 0.5 * squared_norm(velocity);
        momentum += velocity;
      }
    if (frame == 1) {
      first_energy = energy;
      first_momentum = momentum;
    }
    EXPECT_LE(norm(momentum - first_momentum), 1e-6) << frame;
    EXPECT_LE(energy, 1.001 * first_energy) << frame;
    for (std::size_t i = 0; i < 2; ++i) {
      const double whole = volume(rest[i].mesh);
      EXPECT_NEAR(volume(scene.bodies()[i].mesh), whole, 0.2 * whole) << frame;
      most_strained = std::max(most_strained, strained(scene.bodies()[i].mesh, rest[i].mesh));
      if (frame % 2 == 0)
        least = std::min(least, clearance(scene.bodies()[i].mesh, scene.bodies()[1 - i].mesh));
    }
  }
  EXPECT_LT(least, 0.005);  // they touch
  EXPECT_GT(least, -0.02);  // with little penetration
  EXPECT_GT(most_strained, 0.1);
  EXPECT_GT(clearance(scene.bodies()[0].mesh, scene.bodies()[1].mesh), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Scene, Collision, ::testing::Values(SceneKind::letters, SceneKind::bunnies),
                         [](const auto& kind) {
                           return std::string(kind.param == SceneKind::letters ? "Letters" : "Bunnies");
                         });

TEST(Scene, FigureWalksInPlaceInsideItsBox) {
  Scene scene(SceneKind::figure);
  const Mesh first = scene.bodies()[0].mesh, box = scene.bodies()[1].mesh;
  const MeshInfo info = inspect(first);
  EXPECT_TRUE(info.closed && info.manifold && info.oriented);
  EXPECT_EQ(info.components, 1u);
  const Box room = bounds(box);
  double most_strained = 0;
  for (int frame = 1; frame <= 60; ++frame) {
    scene.advance();
    const Mesh& now = scene.bodies()[0].mesh;
    EXPECT_NEAR(volume(now), volume(first), 0.05 * volume(first));
    const Box reach = bounds(now);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GT(reach.lower[k], room.lower[k] + 0.05);
      EXPECT_LT(reach.upper[k], room.upper[k] - 0.05);
    }
    EXPECT_EQ(scene.bodies()[1].mesh.positions, box.positions);
    most_strained = std::max(most_strained, strained(now, first));
  }
  EXPECT_GT(most_strained, 0.05);
  for (std::size_t v = 0; v < first.positions.size(); ++v)  // a double step a second
    EXPECT_LE(norm(scene.bodies()[0].mesh.positions[v] - first.positions[v]), 1e-9);
}

}  // namespace
}  // namespace sdm::scenes

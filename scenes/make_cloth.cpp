// The scene `cloth`.
#include <map>

#include "core/geometry/vec.h"
#include "scenes/box_mesh.h"
#include "scenes/cloth.h"
#include "scenes/rotation.h"
#include "scenes/simulation.h"

namespace sdm::scenes {
namespace {

/// A sphere: an octahedron subdivided 1:4 `cuts` times.
Mesh ball(const Vec3& centre, double radius, int cuts) {
  Mesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
            {}};
  for (; cuts > 0; --cuts) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, mesh.positions.size());
      if (is_new) mesh.positions.push_back(normalized(mesh.positions[a] + mesh.positions[b]));
      return place->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p = centre + radius * p;
  return mesh;
}

class FallingCloth : public Simulation {
 public:
  explicit FallingCloth(std::vector<Scene::Body>& bodies) : cloth_(100, 1) {
    // Rotated, so that the folds differ, and placed off the ball's centre, so that it slides off.
    const Matrix turn = rotation_about({1, 0, 0}, 0.1) * rotation_about({0, 0, 1}, 0.4);
    for (Vec3& p : cloth_.positions()) p = turn * p + Vec3{0.2, 0.06, 0.72};
    Mesh mesh = cloth_.mesh();
    mesh.positions.assign(cloth_.positions().begin(), cloth_.positions().end());
    bodies = {{"cloth", std::move(mesh)},
              {"ball", ball({0, 0, 0.4}, 0.18, 4), false},
              {"floor", box_mesh({{-1, -1, -0.1}, {1, 1, 0}}), false}};
    for (std::size_t i = 1; i < bodies.size(); ++i) solids_.emplace_back(bodies[i].mesh);
  }

  void advance(std::vector<Scene::Body>& bodies) override {
    constexpr int kSteps = 20;
    for (int i = 0; i < kSteps; ++i) cloth_.step(kTimeStep / kSteps, solids_);
    bodies[0].mesh.positions.assign(cloth_.positions().begin(), cloth_.positions().end());
  }

 private:
  Cloth cloth_;
  std::vector<Sites> solids_;
};

}  // namespace

std::unique_ptr<Simulation> make_cloth(std::vector<Scene::Body>& bodies) {
  return std::make_unique<FallingCloth>(bodies);
}

}  // namespace sdm::scenes

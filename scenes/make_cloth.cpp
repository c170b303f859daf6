// The scene `cloth`.
#include "scenes/ball.h"
#include "scenes/box_mesh.h"
#include "scenes/cloth.h"
#include "scenes/rotation.h"
#include "scenes/simulation.h"

namespace sdm::scenes {
namespace {

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

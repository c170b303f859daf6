// The scene `tear`.
#include <sdm/closest_points.h>

#include "scenes/ball.h"
#include "scenes/box_mesh.h"
#include "scenes/cloth.h"
#include "scenes/simulation.h"

namespace sdm::scenes {
namespace {

constexpr std::uint32_t kSide = 50;  // particles
constexpr double kHeight = 0.7, kBallRadius = 0.15;
constexpr double kLimit = 1.3;  // of the length of edges, relative to rest

/// The ball falls freely, but while it touches the cloth, at this speed: it is much heavier than the cloth,
/// and held back.
constexpr double kPushingSpeed = 0.5, kFallAcceleration = 9.81;

class TearingCloth : public Simulation {
 public:
  explicit TearingCloth(std::vector<Scene::Body>& bodies)
      : cloth_(kSide, 1), ball_(ball({0, 0, 0}, kBallRadius, 3)) {
    for (std::uint32_t y = 0; y < kSide; ++y)
      for (const std::uint32_t x : {0u, kSide - 1}) cloth_.pin(y * kSide + x);
    for (Vec3& p : cloth_.positions()) p[2] += kHeight;
    Mesh mesh = cloth_.mesh();
    mesh.positions.assign(cloth_.positions().begin(), cloth_.positions().end());
    cloth_sites_ = std::make_unique<Sites>(mesh);
    bodies = {{.name = "cloth", .mesh = std::move(mesh), .tears = true},
              {.name = "ball", .mesh = ball_at(centre_)},
              {.name = "floor", .mesh = box_mesh({{-1, -1, -0.1}, {1, 1, 0}}), .moves = false}};
    for (std::size_t i = 1; i < bodies.size(); ++i) solids_.emplace_back(bodies[i].mesh);
  }

  void advance(std::vector<Scene::Body>& bodies) override {
    constexpr int kSteps = 20;
    constexpr double kStep = kTimeStep / kSteps;
    const bool touches = distance_to_cloth() < kBallRadius + 2 * cloth_.thickness();
    for (int i = 0; i < kSteps; ++i) {
      speed_ = touches ? kPushingSpeed : speed_ + kStep * kFallAcceleration;
      centre_[2] -= kStep * speed_;
      if (centre_[2] < kBallRadius) {
        centre_[2] = kBallRadius;
        speed_ = 0;
      }
      solids_[0].refit(ball_at(centre_).positions);
      cloth_.step(kStep, solids_);
    }
    bodies[0].edit = cloth_.tear(kLimit);
    apply(bodies[0].mesh, bodies[0].edit);
    bodies[0].mesh.positions.assign(cloth_.positions().begin(), cloth_.positions().end());
    bodies[1].mesh = ball_at(centre_);
    cloth_sites_->edit(bodies[0].edit);
    cloth_sites_->refit(bodies[0].mesh.positions);
  }

 private:
  [[nodiscard]] Mesh ball_at(const Vec3& centre) const {
    Mesh mesh = ball_;
    for (Vec3& p : mesh.positions) p += centre;
    return mesh;
  }
  [[nodiscard]] double distance_to_cloth() const {
    return closest_points(*cloth_sites_, {&centre_, 1})[0].distance;
  }

  Cloth cloth_;
  const Mesh ball_;  ///< around the origin
  Vec3 centre_{0.03, 0.02, kHeight + kBallRadius + 0.08};
  double speed_ = 0;
  std::unique_ptr<Sites> cloth_sites_;
  std::vector<Sites> solids_;  ///< the ball and the floor
};

}  // namespace

std::unique_ptr<Simulation> make_tear(std::vector<Scene::Body>& bodies) {
  return std::make_unique<TearingCloth>(bodies);
}

}  // namespace sdm::scenes

// Two soft bodies that collide.
#pragma once

#include <sdm/sites.h>

#include "scenes/simulation.h"
#include "scenes/soft_body.h"

namespace sdm::scenes {

/// Shape matching, with contacts by closest points in both directions and Coulomb friction.
class SoftPair : public Simulation {
 public:
  /// `shapes`: the meshes of the bodies. `gap`: the distance that contacts maintain between them.
  SoftPair(std::array<SoftBody, 2> bodies, const std::vector<Scene::Body>& shapes, double gap);
  void advance(std::vector<Scene::Body>& bodies) override;

 private:
  void step(double dt);
  void push_apart(std::size_t points, std::size_t solid, double dt);

  std::array<SoftBody, 2> bodies_;
  std::array<Sites, 2> sites_;
  double gap_;
};

}  // namespace sdm::scenes

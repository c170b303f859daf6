// Two soft bodies that collide.
#pragma once

#include <sdm/sites.h>

#include "scene/simulation.h"
#include "scene/soft_body.h"

namespace sdm {

class SoftPair : public Simulation {
 public:
  /// Bodies 0 and 1 of a scene, and the gap that contacts keep between them.
  SoftPair(std::array<SoftBody, 2> bodies, const std::vector<Scene::Body>& shapes, double gap);
  void advance(std::vector<Scene::Body>& bodies) override;

 private:
  void step(double dt);
  void push_apart(std::size_t points, std::size_t solid, double dt);

  std::array<SoftBody, 2> bodies_;
  std::array<Sites, 2> sites_;
  double gap_;
};

}  // namespace sdm

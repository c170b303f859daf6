// Advances a scene from frame to frame: one implementation for each kind.
#pragma once

#include "scenes/scene.h"

#include <memory>
#include <vector>

namespace sdm::scenes {

inline constexpr double kTimeStep = 1.0 / 60;  ///< seconds between frames

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Advances the bodies by kTimeStep.
  virtual void advance(std::vector<Scene::Body>& bodies) = 0;
};

/// Each of these sets `bodies` to the first frame.
std::unique_ptr<Simulation> make_letters(std::vector<Scene::Body>& bodies);
std::unique_ptr<Simulation> make_bunnies(std::vector<Scene::Body>& bodies, const std::filesystem::path& mesh);
std::unique_ptr<Simulation> make_figure(std::vector<Scene::Body>& bodies);
std::unique_ptr<Simulation> make_crowd(std::vector<Scene::Body>& bodies);
std::unique_ptr<Simulation> make_cloth(std::vector<Scene::Body>& bodies);
std::unique_ptr<Simulation> make_tear(std::vector<Scene::Body>& bodies);

}  // namespace sdm::scenes

// What a scene does from frame to frame: one implementation a kind.
#pragma once

#include <sdm/scene.h>

#include <memory>
#include <vector>

namespace sdm {

inline constexpr double kTimeStep = 1.0 / 60;  ///< of frames, in seconds

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Moves the positions of the bodies by kTimeStep.
  virtual void advance(std::vector<Scene::Body>& bodies) = 0;
};

/// Each fills `bodies` with the first frame.
std::unique_ptr<Simulation> make_letters(std::vector<Scene::Body>& bodies);
std::unique_ptr<Simulation> make_bunnies(std::vector<Scene::Body>& bodies, const std::filesystem::path& mesh);
std::unique_ptr<Simulation> make_figure(std::vector<Scene::Body>& bodies);
std::unique_ptr<Simulation> make_cloth(std::vector<Scene::Body>& bodies);

}  // namespace sdm

// The frames of a scene, simulated once.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.h"

namespace sdm::figures {

/// Two bodies, and the positions of both in each frame.
struct Recording {
  std::array<Mesh, 2> first;
  std::array<std::string, 2> names;
  std::vector<std::array<std::vector<Vec3>, 2>> frames;

  /// The meshes of a frame.
  [[nodiscard]] std::array<Mesh, 2> meshes(std::size_t frame) const;
  /// The bounds of both bodies in a frame.
  [[nodiscard]] Box bounds_of(std::size_t frame) const;
};

/// Simulates the first frames of a scene of two bodies. `mesh`: see scenes::SceneOptions. Throws sdm::Error
/// as scenes::Scene does, and what `step` throws, which is called for each frame.
[[nodiscard]] Recording record(scenes::SceneKind kind, int frames, const std::filesystem::path& mesh,
                               const std::function<void(std::string_view)>& step);

}  // namespace sdm::figures

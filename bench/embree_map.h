// The peer: one closest-point query of Embree's a texel.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <span>
#include <vector>

#include "embree_mesh.h"

namespace sdm::bench {

/// Input and output of Embree, in single precision.
struct EmbreeTexel {
  Vec3f point{};
  Vec3f vector{};
  float distance = 0;
  unsigned face = kNone;
};

/// A mesh in a scene of Embree's, built at its highest quality.
class EmbreeScene {
 public:
  explicit EmbreeScene(const Mesh& mesh);

  /// Fills in vector, distance and face for every point, on as many threads as the library uses.
  void closest(std::span<EmbreeTexel> texels) const;

 private:
  DeviceHandle device_;
  SceneHandle scene_;
  std::vector<std::array<Vec3f, 3>> triangles_;
};

}  // namespace sdm::bench

// Distance maps by Embree: one closest-point query per texel.
#pragma once

#include <sdm/mesh.h>

#include <array>
#include <span>
#include <vector>

#include "embree_mesh.h"

namespace sdm::bench {

/// A query and its result, in single precision as everywhere in Embree.
struct EmbreeTexel {
  Vec3f point{};
  Vec3f vector{};
  float distance = 0;
  unsigned face = kNone;
};

/// A mesh in an Embree scene, built at the highest quality.
class EmbreeScene {
 public:
  explicit EmbreeScene(const Mesh& mesh);

  /// Sets vector, distance and face for every point, using as many threads as the library does.
  void closest(std::span<EmbreeTexel> texels) const;

 private:
  DeviceHandle device_;
  SceneHandle scene_;
  std::vector<std::array<Vec3f, 3>> triangles_;
};

}  // namespace sdm::bench

// Occlusion of rays by Embree, of a mesh that deforms.
#pragma once

#include <sdm/mesh.h>
#include <sdm/rays.h>

#include <span>

#include "embree_mesh.h"

namespace sdm::bench {

/// A mesh in an Embree scene for deforming geometry, with robust (watertight) intersections. The tree is
/// built once, at medium quality, and then refitted.
class EmbreeOccluder {
 public:
  explicit EmbreeOccluder(const Mesh& mesh);

  /// Moves the vertices and refits the tree.
  void update(std::span<const Vec3> positions);
  /// Sets result[i] to 1 if ray i, in single precision, meets the mesh, otherwise 0. Uses the calling thread.
  void occluded(std::span<const Ray> rays, std::uint8_t* result) const;

 private:
  DeviceHandle device_;
  SceneHandle scene_;
  unsigned geometry_;
};

}  // namespace sdm::bench

// Many deforming or rigid meshes in FCL's dynamic AABB tree.
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sdm::bench {

/// Distances of all near pairs of meshes by FCL, on one thread.
class FclCrowd {
 public:
  explicit FclCrowd(std::span<const Mesh> meshes);
  ~FclCrowd();

  /// Refits all hierarchies to new positions.
  void refit(std::span<const std::vector<Vec3>> positions);
  /// Sets the pose of every body, a rigid motion.
  void move(std::span<const Transform> poses);

  struct Pair {
    std::uint32_t first, second;  ///< first < second
    double distance;              ///< of the surfaces, with closest points; -1 or 0 where they intersect
  };
  /// Computes the distances of all pairs whose boxes are nearer than max_distance, sorted by first, then
  /// second. Valid until the next call.
  [[nodiscard]] std::span<const Pair> distances(double max_distance);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::bench

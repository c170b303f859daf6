// Many deforming meshes in FCL's dynamic tree of boxes.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sdm::bench {

/// FCL's results for all near pairs of meshes, on one thread.
class FclCrowd {
 public:
  explicit FclCrowd(std::span<const Mesh> meshes);
  ~FclCrowd();

  /// Refits all hierarchies to new positions.
  void update(std::span<const std::vector<Vec3>> positions);

  struct Pair {
    std::uint32_t first, second;  ///< first < second
    double distance;              ///< of the surfaces, with closest points; -1 or 0 where they intersect
  };
  /// Of all pairs whose boxes are nearer than max_distance, by first and then by second; valid until the next
  /// call.
  [[nodiscard]] std::span<const Pair> distances(double max_distance);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::bench

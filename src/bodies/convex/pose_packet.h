// Collisions of a convex solid in several poses at once.
#pragma once

#include <sdm/mesh_edit.h>

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "bodies/convex/convex_mesh.h"
#include "bodies/convex/support_search.h"
#include "mesh/similarity.h"

namespace sdm::convex {

/// Decides collisions of a convex solid in many poses with another one at rest, in single precision: a pose
/// is in one lane of vector registers. What is decided is so beyond rounding errors; the rest, as bodies that
/// barely touch, is left to ConvexPair.
class PosePacket {
 public:
  /// Poses that are decided at once.
  static constexpr std::size_t kPoses = 64;

  /// Both meshes must outlive this object. `pose`: of the one at rest.
  PosePacket(const ConvexMesh& moving, const ConvexMesh& resting, const mesh::Similarity& pose);

  /// relations[i]: overlap, apart, or unknown, which also those of poses that are no rotation and translation
  /// are, to a part of the margins. At most kPoses. Cost: that of comparing all vertices some times, for all
  /// poses together.
  void decide(std::span<const Transform> poses, std::span<Relation> relations) const;

  struct Data {
    const ConvexMesh *moving, *resting;
    std::array<Vec3, 3> turn;      ///< from space to the frame of the one at rest, without the scale
    Vec3 centre;                   ///< of the one at rest, in space
    double unit;                   ///< the size of both
    float moving_size, rest_size;  ///< in units
    double most_skew;              ///< of a pose: the largest entry of R Rᵀ − 1
    double farthest;               ///< of an offset
    float least_inside;            ///< a point that is so deep, relative to the inner radius, is inside
    bool has_planes;
    std::size_t least_open;  ///< of fewer poses, no step is taken
    std::string_view steps;
    bool usable;
  };

 private:
  Data data_;
};

}  // namespace sdm::convex

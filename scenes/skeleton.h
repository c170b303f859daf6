// An articulated figure: a tree of bones with joints, and a skin around them.
#pragma once

#include <span>
#include <vector>

#include "scenes/rotation.h"

namespace sdm::scenes {

/// x ↦ rotation · x + offset
struct Motion {
  Matrix rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 offset{};

  [[nodiscard]] Vec3 operator()(const Vec3& x) const { return rotation * x + offset; }
  [[nodiscard]] Motion operator*(const Motion& inner) const {
    return {rotation * inner.rotation, (*this)(inner.offset)};
  }
};

/// A bone in the rest pose. It rotates about its joint, together with all its descendants.
struct Bone {
  std::size_t parent;  ///< an earlier bone; the first bone is its own parent
  Vec3 joint;
};

/// A part of the shape around a bone: a ball swept from `begin` to `end`, whose radius changes linearly.
struct Muscle {
  std::size_t bone;
  Vec3 begin, end;
  double begin_radius, end_radius;
};

struct Skeleton {
  std::vector<Bone> bones;
  std::vector<Muscle> muscles;
};

/// Approximates the signed distance to the union of the muscles, blended smoothly where they meet; negative
/// inside.
[[nodiscard]] double skin_distance(const Skeleton& skeleton, const Vec3& p);

/// The motion of each bone from the rest pose. `rotations`: those about the joints, relative to the parents.
[[nodiscard]] std::vector<Motion> pose(const Skeleton& skeleton, std::span<const Matrix> rotations);

/// Linear blend skinning: points follow the bones near them.
class Skin {
 public:
  Skin(const Skeleton& skeleton, std::span<const Vec3> rest);
  /// Sets `positions` to the rest positions moved with the bones.
  void move(std::span<const Motion> motions, std::vector<Vec3>& positions) const;

 private:
  std::vector<Vec3> rest_;
  std::vector<std::vector<double>> weights_;  ///< weights of all bones for each point; they sum to 1
};

}  // namespace sdm::scenes

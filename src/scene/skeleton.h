// An articulated figure: bones that hang on each other, and a skin around them.
#pragma once

#include <sdm/mesh.h>

#include <span>
#include <vector>

#include "scene/rotation.h"

namespace sdm {

/// x → rotation · x + offset
struct Motion {
  Matrix rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 offset{};

  [[nodiscard]] Vec3 operator()(const Vec3& x) const { return rotation * x + offset; }
  [[nodiscard]] Motion operator*(const Motion& inner) const {
    return {rotation * inner.rotation, (*this)(inner.offset)};
  }
};

/// A bone at rest: it turns about its joint, and all bones below it with it.
struct Bone {
  std::size_t parent;  ///< a bone before it; the first one is its own
  Vec3 joint;
};

/// Flesh on a bone: a ball that changes its size on its way from one end to the other.
struct Muscle {
  std::size_t bone;
  Vec3 begin, end;
  double begin_radius, end_radius;
};

struct Skeleton {
  std::vector<Bone> bones;
  std::vector<Muscle> muscles;
};

/// Negative within the muscles, blended smoothly where they meet; about the distance outside.
[[nodiscard]] double flesh(const Skeleton& skeleton, const Vec3& p);

/// Each bone's motion from its place at rest, when it turns by `turns` about its joint.
[[nodiscard]] std::vector<Motion> pose(const Skeleton& skeleton, std::span<const Matrix> turns);

/// Points that follow the bones, each those that it is near to (linear blend skinning).
class Skin {
 public:
  Skin(const Skeleton& skeleton, std::span<const Vec3> rest);
  void move(std::span<const Motion> motions, std::vector<Vec3>& positions) const;

 private:
  std::vector<Vec3> rest_;
  std::vector<std::vector<double>> weights_;  ///< of the bones, for each point
};

}  // namespace sdm

// The walls that stop balls, by bounds in single precision.
#pragma once

#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "closest/single_point.h"
#include "tree/aabb_tree.h"
#include "tree/wide_tree.h"

namespace sdm::thickness {

class Walls;

/// Vectors of the children of a wide node, or of the faces of a leaf.
struct EightVectors {
  alignas(32) float at[3][tree::WideTree::kWidth] = {};

  void set(std::size_t i, const std::array<float, 3>& v) {
    for (std::size_t k = 0; k < 3; ++k) at[k][i] = v[k];
  }
};

/// The faces of a leaf: a box around them in the unit frame, along their mean normal and across it, as walls
/// are thin; a point x is in it if lower ≤ (axis · x) ≤ upper for all three axes. And bounds on their
/// normals.
struct LeafWalls {
  float axis[3][3], lower[3], upper[3];
  tree::FloatBox normals;
};

/// The outward normals and boxes of faces, as searches read them.
struct WallNormals {
  std::vector<EightVectors> lower, upper;  ///< of each wide node: bounds on those below its children
  std::vector<EightVectors> of_leaf;       ///< of each leaf
  std::vector<LeafWalls> leaves;
};

/// Where a ray or a ball starts: a point of a face that is measured.
struct WallStart {
  std::uint32_t face = kNone;
  Vec3 point{};
};

/// The end of the ray or the ball of a sample.
struct WallEnd {
  double thickness = kInfinity;
  Vec3 point{};
  std::uint32_t face = kNone;
};

/// Memory of a search for balls, which only grows.
struct BallMemory {
  static constexpr std::size_t kPacket = 16;  ///< balls that are searched together

  std::vector<closest::SinglePointMemory::Open> stack;
};

/// Sets the ends of the balls that start at up to a packet of samples; those that they have already are
/// walls too. Of walls that stop a ball at the same radius, the first face counts. `known`: points of walls
/// that may be near to these ends bound the search, whatever their thickness. Cost: a traversal of the tree;
/// less for each if samples are near each other.
void find_ball_ends(const Walls& walls, std::span<const WallStart> starts, std::span<const WallEnd> known,
                    std::span<WallEnd> ends, BallMemory& memory);

}  // namespace sdm::thickness

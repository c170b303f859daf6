// Cylinders around the nodes of a tree: around a smooth patch of a surface, far thinner than a box.
#pragma once

#include <vector>

#include "sites/regions.h"
#include "tree/wide_tree.h"

namespace sdm::sites {

/// Cylinders, in the unit frame, around the faces below each child of a wide node. Their axes are mean
/// normals: unit vectors, or 0 for a ball of the given radius. Lengths of cylinders are enlarged by this part
/// of themselves and of the unit: more than they are rounded.
inline constexpr float kCylinderRounding = 1e-6f;

struct BoundingCylinders {
  static constexpr int kWidth = tree::WideTree::kWidth;
  alignas(32) float centre[3][kWidth] = {};
  alignas(32) float axis[3][kWidth] = {};
  alignas(32) float radius[kWidth] = {};
  alignas(32) float half_height[kWidth] = {};
};

/// The cylinders of a wide tree. Those around few leaves are computed from the faces, which makes them
/// thinnest; the others from the cylinders two levels below, which takes less time.
class CylinderTree {
 public:
  struct LeafRange {
    std::uint32_t first, count;
  };
  static constexpr std::uint32_t kFewLeaves = 16;
  static constexpr std::uint32_t kLeastLeaves = 256;  ///< smaller trees have no cylinders: searches are short

  CylinderTree() = default;
  /// The leaves of `wide` are those of `regions`. Cost: linear, all cores.
  CylinderTree(const tree::WideTree& wide, const Regions& regions);

  /// The leaves below a child of a wide node.
  [[nodiscard]] LeafRange leaves_of(std::uint32_t child) const;
  [[nodiscard]] bool has_few_leaves(std::uint32_t child) const {
    return leaves_of(child).count <= kFewLeaves;
  }

  /// Those of a tree with these nodes; false if there cannot be so many. Cost: linear.
  [[nodiscard]] bool set_nodes(Array<BoundingCylinders> stored, const tree::WideTree& wide);
  /// Whether all numbers are finite, and no larger than those of any cylinders. Cost: linear.
  [[nodiscard]] bool have_valid_numbers() const;

  Array<BoundingCylinders> nodes;  ///< as those of the wide tree, or none

 private:
  void find_leaves(const tree::WideTree& wide);

  std::vector<LeafRange> leaves_;  // below each node
};

}  // namespace sdm::sites

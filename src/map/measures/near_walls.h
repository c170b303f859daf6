// The faces that may stop a ball, by bounds in single precision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "map/measures/touching_ball.h"
#include "sites/sites_data.h"
#include "tree/visit.h"
#include "tree/wide_tree.h"

namespace sdm::thickness {

/// Vectors of the children of a wide node, or of the faces of a leaf.
struct EightVectors {
  alignas(32) float at[3][tree::WideTree::kWidth] = {};

  void set(std::size_t i, const std::array<float, 3>& v) {
    for (std::size_t k = 0; k < 3; ++k) at[k][i] = v[k];
  }
};

/// The outward normals of faces, as searches read them.
struct WallNormals {
  std::vector<EightVectors> lower, upper;  ///< of each wide node: bounds on those below its children
  std::vector<EightVectors> of_leaf;       ///< of each leaf
};

/// The least radius at which anything has stopped a ball, after the face: stop(data, face).
struct StopByFace {
  double (*stop)(void* data, std::uint32_t face);
  void* data;
};

/// Calls stop(face) for all faces that may reach the ball at a radius up to the least one so far, at first
/// `radius`, if the product of their normal with that of the ball may be above `least_turn`; and for some
/// others. Those with the smallest balls come first, roughly. `stack` is scratch memory.
void for_each_near_wall(const sites::SitesData& sites, const WallNormals& normals, const Touching& ball,
                        double least_turn, double radius, const StopByFace& stop,
                        std::vector<tree::OpenNode>& stack);

}  // namespace sdm::thickness

// Balls about the nodes of the tree of a body.
#pragma once

#include "geometry/rounding.h"
#include "mesh/similarity.h"
#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::shape {

struct Ball {
  Vec3 centre{};
  double radius = 0;
};

/// The ball about the box of the i-th child of the node, mapped by `map`. A similarity preserves balls, so
/// one is as tight in any frame.
[[nodiscard]] inline Ball ball_of_child(const sites::SitesData& sites, std::uint32_t node, std::uint32_t i,
                                        const mesh::Similarity& map) {
  const tree::FloatBox box =
      tree::box_of(sites.tree, sites.wide, {.slot = tree::WideTree::kWidth * node + i});
  Vec3 centre, half;
  for (std::size_t k = 0; k < 3; ++k) {
    const double lo = box.lower[k], hi = box.upper[k];
    centre[k] = sites.frame.origin[k] + 0.5 * (lo + hi) / sites.frame.scale;
    half[k] = (0.5 * (hi - lo) + kSingleRounding) / sites.frame.scale;
  }
  return {map.map(centre), map.scale * norm(half)};
}

}  // namespace sdm::shape

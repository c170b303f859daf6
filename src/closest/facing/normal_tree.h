// A tree over the normals of faces, wherever the faces are.
#pragma once

#include <algorithm>

#include "geometry/vec.h"
#include "sites/sites_data.h"
#include "tree/aabb_tree.h"

namespace sdm::facing {

/// The unit normals, as points, of the faces that have_normal(). Its items are faces. Cost: O(n log n), all
/// cores.
[[nodiscard]] tree::AabbTree normal_tree(const sites::SitesData& sites);

/// An upper bound on n·m of the vectors m in a box, which are no longer than 1, for a unit vector n.
[[nodiscard]] inline double largest_cosine(const tree::FloatBox& box, const Vec3& n) {
  constexpr double kRounding = 1e-12;
  double sum = kRounding;
  for (int k = 0; k < 3; ++k) sum += std::max(n[k] * double{box.lower[k]}, n[k] * double{box.upper[k]});
  return sum;
}

}  // namespace sdm::facing

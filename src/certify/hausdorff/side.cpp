#include "certify/hausdorff/side.h"

#include <algorithm>

#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "query/inside/solid.h"
#include "tree/visit.h"

namespace sdm::hausdorff {

bool Side::has(const Vec3& p) const {
  return inside::contains(solid_, p) == inside_;
}

bool Side::is_one_sided(const Corners& triangle) const {
  // Mapping corners into the frame rounds.
  Box box;
  for (const Vec3& corner : triangle) {
    Vec3 unit = solid_.frame.to_unit(corner), rounding;
    for (int k = 0; k < 3; ++k) rounding[k] = kFewRoundings * (1 + std::abs(unit[k]));
    extend(box, unit - rounding), extend(box, unit + rounding);
  }
  const tree::FloatBox around = tree::FloatBox::around(box);
  bool apart = true;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) { return apart && distance == 0; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : solid_.tree.items_of(node))
      if (apart && triangles_intersect(triangle, corners_of(solid_.mesh, face))) apart = false;
  };
  tree::visit(solid_.tree, tree::NearestFirst{bound, enter, leaf});
  return apart;
}

}  // namespace sdm::hausdorff

// Cones that contain the normals of the faces below the nodes of a tree.
#pragma once

#include <algorithm>
#include <vector>

#include "core/lazy/kept.h"
#include "sites/sites_data.h"
#include "tree/aabb_tree.h"

namespace sdm::facing {

/// The unit vectors within an angle of an axis.
struct Cone {
  std::array<float, 3> axis{};
  float cosine = 2, sine = 0;  ///< of the angle, which is at most 180°; 2: there is no vector
};

/// The cones of all nodes of sites.tree, of the normals of the faces that have_normal(). Each contains these
/// to 1e-6. Cost: linear.
[[nodiscard]] std::vector<Cone> normal_cones(const sites::SitesData& sites);

/// Whether the normal of a face is more than rounding.
[[nodiscard]] inline bool has_normal(const sites::SitesData& sites, std::uint32_t face) {
  return sites.sliver[face] == 0 && sites.normals.face[face] != Vec3{};
}

/// An upper bound on n·m of the vectors m of the cone, for a unit vector n; −2 if there is none.
[[nodiscard]] inline double largest_cosine(const Cone& cone, const Vec3& n) {
  if (cone.cosine > 1) return -2;
  constexpr double kRounding = 1e-5;  // of single precision, and more
  const double c = n[0] * cone.axis[0] + n[1] * cone.axis[1] + n[2] * cone.axis[2];
  if (c >= cone.cosine) return 1 + kRounding;
  // cos(φ − θ), with φ = arccos c and the angle θ of the cone.
  const double s = std::sqrt(std::max(0.0, 1 - c * c));
  return c * cone.cosine + s * cone.sine + kRounding;
}

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

// What bounds the normals of many faces at once, kept with the sites.

struct NormalBounds {
  std::vector<Cone> cones;         ///< normal_cones()
  Kept<tree::AabbTree> by_normal;  ///< normal_tree(), which most searches do without
};

/// Those of the present shape, valid until it changes. Cost: linear in the faces for the first call, then
/// O(1).
[[nodiscard]] const NormalBounds& normal_bounds_of(const sites::SitesData& sites);

}  // namespace sdm::facing

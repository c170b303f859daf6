// The generalised winding number of a triangle soup.
#pragma once

#include <sdm/types.h>

#include <vector>

#include "sites/sites_data.h"

namespace sdm::inside {

/// How many times the mesh winds around a point (Jacobson, Kavan & Sorkine 2013): 1 inside and 0 outside a
/// closed mesh, in between around an open one. Distant subtrees are replaced by dipoles (Barill et al. 2018),
/// with a bound on the error of each.
class WindingNumber {
 public:
  explicit WindingNumber(const sites::SitesData& sites);

  /// The winding number around q to within `error` (and rounding, 1e-12). Cost: logarithmic for large errors,
  /// linear for 0.
  [[nodiscard]] double operator()(const Vec3& q, double error) const;
  /// Whether it is above 1/2. Computed only as accurately as this takes.
  [[nodiscard]] bool above_half(const Vec3& q) const;

 private:
  struct Dipole {
    Vec3 centre{};  ///< area-weighted mean of the faces' centroids
    Vec3 moment{};  ///< sum of the faces' normals times areas
    double area = 0;
    double radius = 0;  ///< of a ball around the centre that contains the subtree
  };

  const sites::SitesData& sites_;
  std::vector<Dipole> dipoles_;  ///< one per node of the tree
};

}  // namespace sdm::inside

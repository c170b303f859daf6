// The faces of B that the points of a face of A are measured to, if not all.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/vec.h"
#include "query/closest/reference.h"
#include "query/facing/facing_search.h"

namespace sdm::hausdorff {

/// Allows the faces of B that face the same way as a face of A, within an angle. The distance to those of one
/// face is that to a fixed set, and so 1-Lipschitz on the face: as a function on all of A it jumps from face
/// to face.
class Matching {
 public:
  /// `normals`: of the faces of A, unit length or 0. Cost: linear in the faces of B. Throws sdm::Error for an
  /// angle out of range.
  Matching(const sites::SitesData& b, double angle, std::vector<Vec3> normals)
      : b_(b), search_(b, angle), normals_(std::move(normals)) {}

  /// Whether a face of A has a normal: those without area have no points of their own.
  [[nodiscard]] bool has_normal(std::uint32_t face) const { return normals_[face] != Vec3{}; }
  [[nodiscard]] bool allows(std::uint32_t face, std::uint32_t other) const {
    return search_.allows(normals_[face], other);
  }
  /// Whether there may be an allowed face below a node of B's tree.
  [[nodiscard]] bool may_allow(std::uint32_t face, std::uint32_t node) const {
    return search_.may_allow(node, normals_[face]);
  }

  /// Whether a point of a face of A is behind the faces that it is measured to.
  [[nodiscard]] bool behind(std::uint32_t face, const Vec3& p) const {
    constexpr double kAnywhere = std::numeric_limits<double>::infinity();
    return search_.match(p, normals_[face], kAnywhere, closest::reference_closest(b_, p, kAnywhere)).behind;
  }

 private:
  const sites::SitesData& b_;
  facing::FacingSearch search_;
  std::vector<Vec3> normals_;
};

}  // namespace sdm::hausdorff

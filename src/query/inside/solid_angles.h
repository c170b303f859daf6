// The solid angle of many triangles, as accurately as it is needed.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <vector>

#include "query/inside/oriented_faces.h"
#include "query/inside/solid_angle.h"

namespace sdm::inside {

/// The sum of the solid angles of the faces of a tree, where those of distant subtrees are expanded about
/// their centres (Barill et al. 2018, up to the first derivative), with a bound on the error of each.
///
/// The angle of a subtree is the integral over its faces of n·K(x − q), K(r) = r/|r|³. With c the centre,
///   n·K(x − q) = n·K(c − q) + n·DK(c − q)(x − c) + remainder,
/// of which the first two integrals follow from sums over the faces: M = ∫ n dA, T = ∫ (x − c) nᵀ dA. K is
/// the gradient of −1/|r|, whose derivatives of order k have norms of at most k!/|r|^(k+1) (attained along
/// r). The remainder is thus at most (1/2)·6·∫|x − c|² dA / g⁴, and without the second term at most 2·A·R/g³,
/// where all faces lie in a ball about c with the radius R, and g = |c − q| − R.
class SolidAngles {
 public:
  /// The faces must outlive this object and not change. Cost: linear.
  explicit SolidAngles(const OrientedFaces& faces);

  /// What is known of the sum at a point q.
  struct Sum {
    SolidAngle angle;
    double reach = 0;  ///< at points nearer to q than this, the sum is on the same side of the limit
  };
  /// The sum at q: refined, the largest error first, until twice the error is smaller than its distance from
  /// `limit` or the error is at most `tolerance`, or until no expansion is left.
  [[nodiscard]] Sum at(const Vec3& q, double limit, double tolerance) const;

  [[nodiscard]] bool empty() const { return nodes_.empty(); }

 private:
  struct Node {
    Vec3 centre{};                  ///< area-weighted mean
    Vec3 moment{};                  ///< M
    std::array<double, 6> first{};  ///< the symmetric part of T: xx, yy, zz, xy, yz, zx
    double area = 0;
    double second = 0;  ///< ∫|x − c|² dA
    double radius = 0;
  };
  struct Term;
  class Refinement;

  static void add(Node& sum, const Node& part);
  [[nodiscard]] Node of_face(std::uint32_t face) const;
  void finish(Node& node, const tree::FloatBox& box) const;
  [[nodiscard]] Vec3 middle(const tree::FloatBox& box) const;

  OrientedFaces faces_;
  std::vector<Node> nodes_;  ///< one per node of the tree
};

}  // namespace sdm::inside

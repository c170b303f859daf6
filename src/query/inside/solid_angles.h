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
/// of which the first two integrals follow from sums over the faces: M = ∫ n dA, T = ∫ (x − c) nᵀ dA.
///
/// The remainder. K is the gradient of −1/|r|, whose derivatives of order k have norms of at most
/// k!/|r|^(k+1) (attained along r). With d = |c − q| and s = |x − c| / d < 1, the terms of order k ≥ 2 of the
/// series of K at c − q are thus at most (k+1)·sᵏ/d², and their sum
///   (1/(1 − s)² − 1 − 2s) / d² = s²·(3 − 2s) / ((1 − s)²·d²),
/// where (3 − 2s)/(1 − s)² increases with s. If all faces lie in a ball about c with the radius R = S·d, the
/// remainder is at most (3 − 2S)/(1 − S)² · ∫|x − c|² dA / d⁴.
///
/// Rounding, with u = 2⁻⁵³. Positions are taken relative to the origin of the frame, in whose unit L they are
/// at most 1 in each coordinate. Wherever that origin is, the difference of two numbers is rounded by u times
/// itself, so a centre of a face is computed within 9·u·L, and q within u·|q|. The sums are therefore those
/// of faces and of a q that are displaced by less than δ = 16·u·(L + |q|) in all, which changes K by at most
/// 2·δ/g³, g = d − R, if R is larger by δ. The edges a and b of a face are rounded by u times themselves, and
/// ½ a × b by 4·u·|a||b|; the sums, at most kDeepest + 8 additions one after the other, and the terms, of
/// fewer than 64 operations, are rounded by less than 256·u/g² times P, the sum of |a||b| over all faces.
class SolidAngles {
 public:
  /// The faces must outlive this object and not change. Cost: linear.
  explicit SolidAngles(const OrientedFaces& faces);

  /// What is known of the sum at a point q.
  struct Sum {
    SolidAngle angle;
    double reach = 0;  ///< at points nearer to q than this, the sum is on the same side of the limit
  };
  /// The sum at q: refined, the largest errors first, until twice the error is smaller than its distance from
  /// `limit` or the error is at most `tolerance`, or until no expansion is left.
  [[nodiscard]] Sum at(const Vec3& q, double limit, double tolerance) const;

  [[nodiscard]] bool empty() const { return nodes_.empty(); }

 private:
  struct Node {
    Vec3 centre{};                  ///< area-weighted mean, relative to the origin of the frame
    Vec3 moment{};                  ///< M
    std::array<double, 6> first{};  ///< the symmetric part of T: xx, yy, zz, xy, yz, zx
    double area = 0;
    double second = 0;  ///< ∫|x − c|² dA
    double radius = 0;  ///< R
    double edges = 0;   ///< P
  };
  struct Term;
  class Refinement;

  static void add(Node& sum, const Node& part);
  [[nodiscard]] Node of_face(std::uint32_t face) const;
  void set_centre(Node& node, const tree::FloatBox& box) const;
  [[nodiscard]] double radius_by_box(const Vec3& centre, const tree::FloatBox& box) const;
  [[nodiscard]] double radius_of_leaf(const Vec3& centre, std::uint32_t leaf) const;

  OrientedFaces faces_;
  std::vector<Node> nodes_;  ///< one per node of the tree
  double unit_ = 1;          ///< L
};

}  // namespace sdm::inside

// A part of a face of A, and an upper bound on the distance from its points to B.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "geometry/triangle.h"
#include "sites/sites_data.h"

namespace sdm::hausdorff {

/// A triangle of A or a part of one, with faces S_k of B that are near it.
///
/// The bound: d(p, B) ≤ d(p, S_k) for each k, so also ≤ Σ μ_k d(p, S_k) for weights μ_k ≥ 0 with sum 1. As
/// the distance to a convex set is convex, so is this sum: its maximum over the triangle is attained at a
/// corner. `upper` is the smallest of these maxima over all μ, the value of a matrix game. By duality it is
/// also the maximum over the triangle of min over k of l_k, where l_k is linear and equal to d(·, S_k) at the
/// corners. `weights` are the barycentric coordinates of that maximum. It exceeds the maximum of min over k
/// of d(·, S_k) by the square of the size of the triangle only, even where several S_k are equally close.
struct FacePart {
  static constexpr int kMostFaces = 6;

  Corners at{};                                     ///< the corners a_i
  std::uint32_t face = kNone;                       ///< of A
  std::uint16_t depth = 0;                          ///< number of divisions
  bool stalled = false;                             ///< the last division did not improve the bound
  std::uint16_t count = 0;                          ///< number of S_k
  std::array<std::uint32_t, kMostFaces> b_faces{};  ///< S_k
  std::array<Vec3, kMostFaces> distances{};         ///< d(a_i, S_k), rounded upwards, at [k][i]
  double upper = kInfinity;
  Vec3 weights{};
  std::uint32_t mixed = 0;  ///< a bit for each k with μ_k > 0

  /// Adds a face, in place of one that is not mixed if there are kMostFaces. Returns false, and does nothing,
  /// if another is as close, up to the tolerance.
  bool add(const sites::SitesData& b, std::uint32_t near_face, double tolerance);
  /// Sets `upper` and `weights`. There must be a face.
  void bound();
  /// Where the bound is attained if distances were linear.
  [[nodiscard]] Vec3 highest_point() const;
  /// Number of corners with a positive weight.
  [[nodiscard]] int support() const;
  /// The index of the face closest to a corner.
  [[nodiscard]] int closest(int corner) const;
};

/// Up to three parts that make up a part.
struct Pieces {
  std::array<FacePart, 3> part;
  int count = 0;
};

/// Cuts a part along a side of the face that is nearest to its highest point, moved outwards, if the part
/// lies along the plane of the face: a piece above the face is then settled, however long and thin both are
/// and however they cross. `enough`: a bound at which a part is settled. No pieces if no side cuts the part,
/// or the face is so small beside it that halving is better. Sets the bounds of the pieces.
[[nodiscard]] Pieces cut_along(const FacePart& part, const sites::SitesData& b, std::uint32_t near_face,
                               double enough);

/// Divides a part by segments from one of its points to its corners, where that helps faces of B to be the
/// closest on a whole piece each: at a vertex that the mixed faces share, or at the place on a side where two
/// faces are equally far. After a division that did not improve the bound, a side is cut in the middle, the
/// longest. `tolerance` is the difference of distances that counts as equal. Sets the bounds of the pieces.
[[nodiscard]] Pieces divide(const FacePart& part, const sites::SitesData& b, double tolerance);

/// A cut of a triangle by a line: one corner is alone on its side of it.
struct SideCut {
  int alone = 0;
  std::array<double, 2> at{};  ///< along the sides from that corner to the next two
};

/// The cut along the side of a face that the triangle reaches beyond the most, moved outwards by `offset`.
/// `normal`: of the face, of length 1. Nothing unless there are corners farther than `margin` from the line
/// on either side of it.
[[nodiscard]] std::optional<SideCut> cut_along_side(const Corners& triangle, const Corners& face,
                                                    const Vec3& normal, double offset, double margin);

[[nodiscard]] double longest_side(const Corners& triangle);

}  // namespace sdm::hausdorff

// Triangles with an orientation of each, and a tree over them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/crossings/ray_parity.h"
#include "sites/sites_data.h"
#include "tree/wide_tree.h"

namespace sdm::inside {

struct OrientedFaces {
  FaceTree faces;
  std::span<const std::uint8_t> inverted;  ///< of each face: its corners are taken in reverse; empty: of none

  /// The corners in the order of the orientation.
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t face) const {
    const Triangle& t = faces.triangles[face];
    const bool reverse = !inverted.empty() && inverted[face] != 0;
    return {faces.positions[t[0]], faces.positions[t[reverse ? 2 : 1]], faces.positions[t[reverse ? 1 : 2]]};
  }
};

/// The faces of sites with the orientation that signs use. Valid for the lifetime of the sites.
[[nodiscard]] inline OrientedFaces oriented_faces(const sites::SitesData& sites) {
  return {sites.face_tree(), sites.inverted};
}

/// The expansions of the children of a wide node, one per lane, in the unit frame and single precision
/// (Barill et al. 2018, up to the first derivative).
///
/// The angle of a child seen from q is the integral over its faces of n·K(x − q), K(r) = r/|r|³. With c the
/// centre,
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
/// Rounding in double precision, with w = 2⁻⁵³. Positions are taken relative to the origin of the frame,
/// where they are at most 1 in each coordinate. Wherever that origin is, the difference of two numbers is
/// rounded by w times itself, so a centre of a face is computed within 9·w, and q within w·|q|. The sums are
/// therefore those of faces and of a q that are displaced by less than δ = 16·w·(1 + |q|) in all, which
/// changes K by at most 2·δ/g³, g = d − R, if R is larger by δ. The edges a and b of a face are rounded by w
/// times themselves, and ½ a × b by 4·w·|a||b|; the sums, at most kDeepest + 8 additions one after the other,
/// by less than 256·w/g² times P, the sum of |a||b| over all faces.
///
/// Rounding in single precision, with u = 2⁻²⁴. The centre c is a number of single precision, so that it has
/// no error. q is split into two such numbers, whose sum is within u²·|q| of it; with r = (c − q₁) − q₂ each
/// coordinate of c − q is within 3·u of itself and 4·u²·|q|, of which δ contains the second, where it is
/// 512·w·(1 + |q|). Then d is within 5·u of itself, and 1/d³ within 15·u. |M| is at most the area A, and the
/// symmetric part of T, in the Frobenius norm, R·A < d·A. M·r is rounded by 7·u·A·d, the trace of T by
/// 6·u·A·d, rᵀT r/d² by 21·u·A·d, the sum of the first two and −3 times the third by 23·u·A·d, and the
/// product with 1/d³ by 15·u times 6·A·d, all in all by less than 256·u·A/d². What underflows is far below
/// kNoise.
struct Expansions {
  static constexpr int kWidth = tree::WideTree::kWidth;
  /// δ / (1 + |q|).
  static constexpr double kDisplacement = 512 * 0x1p-53;

  alignas(32) float centre[3][kWidth] = {};  ///< c, near the area-weighted mean
  alignas(32) float moment[3][kWidth] = {};  ///< M
  alignas(32) float first[6][kWidth] = {};   ///< the symmetric part of T: xx, yy, zz, xy, yz, zx
  // Rounded upwards:
  alignas(32) float area[kWidth] = {};    ///< A
  alignas(32) float second[kWidth] = {};  ///< ∫|x − c|² dA
  alignas(32) float radius[kWidth] = {};  ///< R, with δ at the origin
  alignas(32) float noise[kWidth] = {};   ///< 256·u·A + 256·w·P: the rounding of a value, times g²
};

/// The expansions of single faces, in the order of the leaves. About its centroid a flat face has T = 0.
struct FaceExpansions {
  /// Bounds the rounding of a centre, which is not chosen as a number of single precision.
  static constexpr double kCentreRounding = 2e-7;

  std::array<std::vector<float>, 3> centre, moment;
  std::vector<float> second, radius, noise;  ///< with what the rounding of the centre adds

  /// Resizes all arrays, padded to whole vectors of lanes; the padding is set.
  void resize(std::size_t faces);
};

struct TreeExpansions {
  std::vector<Expansions> nodes;  ///< of the wide tree
  FaceExpansions faces;
};
/// The expansions of the wide tree of these faces, and of each face. Cost: linear.
[[nodiscard]] TreeExpansions expansions_of(const OrientedFaces& faces, const tree::WideTree& wide);

}  // namespace sdm::inside

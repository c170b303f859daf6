/// Proofs that every distance of a surface is within a tolerance, or that one is not: of all points, not only
/// of samples.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/progress.h>
#include <sdm/sign.h>
#include <sdm/sites.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

namespace sdm {

/// What has been proven of a surface and a tolerance.
enum class Proof {
  holds,      ///< every point of the surface is within the tolerance
  fails,      ///< some point is out of it by more than the accuracy, or has nothing to be measured to
  undecided,  ///< neither
};

/// A point of the surface, and what is known of its distance.
struct ToleranceWitness {
  Vec3 point{}, closest{};                           ///< on the surface, and the point of O2 closest to it
  std::uint32_t face = kNone, closest_face = kNone;  ///< that contain these
  double distance = 0;                               ///< |closest − point|, negative inside O2
};

template <>
inline constexpr std::tuple kFields<ToleranceWitness>{
    Field{"distance", &ToleranceWitness::distance, "Its distance, negative inside O2."},
    Field{"point", &ToleranceWitness::point, "Where it is."},
    Field{"closest", &ToleranceWitness::closest, "The point of O2 closest to it."},
    Field{"face", &ToleranceWitness::face, "The face of O1 that contains it."},
    Field{"closest_face", &ToleranceWitness::closest_face,
          "The face of O2 that contains the closest point."}};

/// The answer of prove_tolerance().
struct ToleranceProof {
  Proof proof = Proof::undecided;
  /// A point out of the tolerance: of Proof::fails, unless the only reason is that faces have no match; if
  /// undecided, one that is out of it by no more than the accuracy, if one was found.
  std::optional<ToleranceWitness> witness{};
  bool at_lower = false;  ///< the limit that the witness exceeds or, without one, that was not proven
  /// If undecided: no point is out of the tolerance by more than this. At most the accuracy, unless the
  /// search ended at ToleranceProofOptions::most_parts. Nothing if signs are the reason.
  std::optional<double> undecided_by{};
  /// Undecided because it depends on signs that are estimates (is_estimate()): some point
  /// is within the tolerance with one sign and out of it with the other, and of SignMethod::side, that it has
  /// the right one is not proven.
  bool depends_on_signs = false;
  /// Set with ToleranceProofOptions::facing: the number of faces of the surface with an area, but without an
  /// allowed face of O2. They have no distance, so that the tolerance never holds.
  std::size_t faces_without_match = 0;
};

template <>
inline constexpr std::tuple kFields<ToleranceProof>{
    Field{"witness", &ToleranceProof::witness,
          "A point between texels and vertices that is out of the tolerance, if the verdict depends on one."},
    Field{"undecided_by", &ToleranceProof::undecided_by,
          "If not decided: no point is out of the tolerance by more than this. Nothing if it is not known."},
    Field{"depends_on_signs", &ToleranceProof::depends_on_signs,
          "It is not decided because of signs that are estimates."},
    Field{"faces_without_match", &ToleranceProof::faces_without_match,
          "The number of faces that no face of O2 faces: they have no distance."}};

/// Options of prove_tolerance().
struct ToleranceProofOptions {
  SignMethod sign = SignMethod::automatic;  ///< as of a map
  /// Distances that exceed a limit by no more than this, in units of the meshes, are not out of the
  /// tolerance, as rounding may be the reason; but no tolerance is proven to hold with such a distance. ≥ 0
  double accuracy = 0;
  /// Distances are those of maps with MapOptions::facing, to the faces of O2 that face the same way. They are
  /// 1-Lipschitz within each face of the surface, so that symmetric limits are decided for every point.
  /// Others are decided as with estimated signs, by |d| alone.
  std::optional<double> facing{};
  /// The faces of the surface that matter; by default all.
  std::optional<std::span<const std::uint32_t>> faces{};
  /// The search ends, undecided, after so many parts of the surface were examined in one step of the proof.
  std::size_t most_parts = std::size_t{1} << 20;
  Progress progress{};
};

/// Decides whether all points of a surface have distances to O2 within a tolerance, by branch and bound as of
/// one_sided_hausdorff(), which ends as soon as the answer is known. Unsigned distances are never negative,
/// so that a lower limit of 0 or less holds. Each side of O2 has its own limits: signs are decided exactly
/// where the distance exceeds a limit. With estimated signs, what |d| alone decides is proven: points that
/// are within the tolerance with either sign, such as those on O2, are within it. Of SignMethod::side, those
/// that are within it with one sign only are, if that is their side for each site of O2 that may be the
/// closest one. The rest is undecided with `depends_on_signs`: points out of the tolerance on their side,
/// points whose closest site may be on the boundary of O2, and where sites that are equally close disagree;
/// any such point of SignMethod::winding, and with `facing`.
///
/// A proof holds to 1e-12 of the diagonal of both meshes and of their largest coordinate. It is undecided
/// only if the most extreme distance is that close to a limit, or beyond it by no more than the accuracy; if
/// it depends on estimated signs; or at the end of the search (`most_parts`), which happens where the surface
/// touches O2 at a limit of 0 that distinguishes signs. The result does not depend on the number of threads.
///
/// Throws sdm::Error if the surface is unusable (see validate), for a face that it does not have, a tolerance
/// that is not finite and ordered, an accuracy that is negative or NaN, a sign method that O2 does not
/// permit or that distances with `facing` do not have, an angle out of range, a tolerance that needs a sign
/// where distances have none, or if there is not enough memory; Cancelled. Cost: as of one_sided_hausdorff(),
/// but only near the points that may be out of the tolerance.
[[nodiscard]] SDM_API ToleranceProof prove_tolerance(const Mesh& surface, const Sites& sites,
                                                     const Tolerance& tolerance,
                                                     const ToleranceProofOptions& options = {});

}  // namespace sdm

/// Verdicts on a tolerance that hold for every point of a surface: by the map where its error bound decides,
/// otherwise by a proof.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/api.h>
#include <sdm/doubts.h>
#include <sdm/map.h>
#include <sdm/names.h>
#include <sdm/progress.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/tolerance_proof.h>

#include <optional>
#include <span>

namespace sdm {

/// A verdict, with the proof that led to it.
struct CertifiedVerdict : ToleranceVerdict {
  std::optional<ToleranceProof> proof{};  ///< where the samples of the map did not decide
  /// Set where walls of O2 are thinner than twice the tolerance, so that a pass by the closest points says
  /// nothing: whether distances to the faces of O2 that face the same way, within 90°, decide. The proof is
  /// of these.
  std::optional<bool> by_facing{};
};

/// What is known of every verdict.
template <>
inline constexpr auto kFields<CertifiedVerdict> = kFields<ToleranceVerdict>;

/// Returns the doubt about a pass by the closest points where walls are thin, and faces that face the same
/// way do not decide.
[[nodiscard]] SDM_API std::optional<Doubt> doubt_of(const CertifiedVerdict& verdict);

/// Options of certify_tolerance().
struct CertifyOptions {
  double error_bound = 0;              ///< of the map: covering_radius() of its surface
  double accuracy = 0;                 ///< of the distances: engine_accuracy(); infinite if unknown
  double guard = 0;                    ///< Evidence::guard
  std::optional<double> thin_walls{};  ///< those of O2, if they are known
  bool accept_doubts = false;          ///< doubt_of() the verdict leaves a pass one
  Progress progress{};
};

/// Returns the judgement that a proof leads to, of samples that alone decide nothing for every point.
[[nodiscard]] SDM_API Judgement judge(const Judgement& of_samples, const ToleranceProof& proof);

/// check_tolerance() and, where that does not decide because distances between the samples or the rounding of
/// a sample leave it open, prove_tolerance(). Verdict::not_decided remains for an extreme distance within the
/// accuracy of a limit, for what depends on signs that are estimates (see prove_tolerance()), where nothing
/// was measured, and for an unknown accuracy. Of DistanceKind::facing, where samples bound nothing, each pass
/// of the samples is proven: a proof of prove_tolerance() with the angle of the map, and Verdict::fail with
/// VerdictReason::without_match for a face that no face of O2 matches. Where asymmetric limits depend on
/// signs, their pass stays an estimate. Of other kinds, samples decide alone. Where distances are to the
/// closest point and walls of O2 are thinner than twice the tolerance (thin_walls()), a pass needs the proof
/// of DistanceKind::facing too, at 90°, which may make a failure of it; if that decides nothing, it is
/// Verdict::doubtful, for the reason of doubt_of(). Errors as of both. Cost: that of check_tolerance() and,
/// unless it decides, of the proof.
[[nodiscard]] SDM_API CertifiedVerdict certify_tolerance(const Surface& surface, const Sites& sites,
                                                         const DistanceMap& map,
                                                         std::span<const float> vertex_distances,
                                                         const Tolerance& tolerance,
                                                         const CertifyOptions& options);

}  // namespace sdm

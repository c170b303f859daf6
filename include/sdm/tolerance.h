/// Checks of a map against a tolerance, and the bounds that certify them.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/api.h>
#include <sdm/engine.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/surface.h>

#include <span>

namespace sdm {

/// The distances that are accepted: lo ≤ d ≤ hi, in units of the meshes.
struct Tolerance {
  double lo = 0, hi = 0;

  Tolerance() = default;
  /// −t ≤ d ≤ t; also for unsigned distances.
  Tolerance(double t) : lo(-t), hi(t) {}  // NOLINT(google-explicit-constructor): a number is a tolerance
  /// least ≤ d ≤ most.
  Tolerance(double least, double most) : lo(least), hi(most) {}

  /// Whether it tells distances apart that differ by their sign only, which unsigned distances do not have.
  [[nodiscard]] bool needs_sign() const { return lo < 0 && -lo != hi; }
  friend bool operator==(const Tolerance&, const Tolerance&) = default;
};

/// Fractions of the area of a map's texels, in [0, 1]; they add up to 1. All are 0 for a map without texels.
struct ToleranceShares {
  double below = 0;          ///< d < lo, by more than the accuracy of a distance
  double within = 0;         ///< lo ≤ d ≤ hi
  double above = 0;          ///< d > hi, by more than the accuracy
  double without_value = 0;  ///< farther than the maximum distance of the map
};

/// `accuracy`: the error of a distance, as of engine_accuracy(): rounding exceeds no tolerance. Throws
/// sdm::Error if the map belongs to another surface. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API ToleranceShares tolerance_shares(const Surface& surface, const DistanceMap& map,
                                                       const Tolerance& tolerance, double accuracy);

/// What a map proves about a tolerance.
enum class Verdict {
  pass,         ///< every point of the surface is within the tolerance
  fail,         ///< some sample or vertex is not
  not_decided,  ///< all samples and vertices are, but points between them may not be
};

/// Whether all distances of a surface are within a tolerance, in units of the mesh.
struct ToleranceVerdict {
  Tolerance tolerance{};
  /// Of |distance|, over all samples and all vertices of faces; infinite if one of them has no value.
  double largest = 0;
  /// Fraction of the area, in [0, 1], of texels whose distance is out of the tolerance by more than the error
  /// of the engine, or that have no value.
  double exceeded_area_fraction = 0;
  ToleranceShares shares{};
  bool within = true;  ///< all samples and vertices are within the tolerance, but for the error of the engine
  /// The verdict holds for the whole surface. If within: no distance comes closer to a limit than
  /// error_bound, since distances are 1-Lipschitz; where signs are estimates (SignMethod::winding), whatever
  /// the signs. Otherwise true, as one sample or vertex is enough to exceed a tolerance, unless it depends on
  /// the sign of an estimate.
  bool certified = true;
  Verdict verdict = Verdict::pass;
  /// If not decided: an error bound that leads to Verdict::pass if no sample of the finer map comes closer to
  /// a limit than half of the present margin. 0 if no error bound does, as the margin is within the error of
  /// the engine.
  double deciding_bound = 0;
};

/// `vertex_distances`: the distance at each vertex of surface.mesh(), NaN if it has no value. `accuracy`:
/// the error of a distance, as of engine_accuracy(): rounding exceeds no tolerance. `error_bound`: upper
/// bound on how much a distance at any point of the surface can differ from those at samples and vertices,
/// as of SamplingBound::value(), without that error. Throws sdm::Error if the map or the distances belong to
/// another surface, or if the tolerance needs a sign and the map is unsigned. Cost: linear in texels and
/// faces.
[[nodiscard]] SDM_API ToleranceVerdict check_tolerance(const Surface& surface, const DistanceMap& map,
                                                       std::span<const float> vertex_distances,
                                                       double error_bound, double accuracy,
                                                       const Tolerance& tolerance);

/// Returns an upper bound on the error of any distance that the engine computes from points of `on` to `to`,
/// in units of the meshes, including the rounding to float: EngineInfo::relative_error times the diagonal of
/// the bounding box of both meshes. Cost: linear.
[[nodiscard]] SDM_API double engine_accuracy(const EngineInfo& engine, const Mesh& on, const Mesh& to);

}  // namespace sdm

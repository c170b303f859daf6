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

/// Whether all distances of a surface are within a tolerance, in units of the mesh.
struct ToleranceVerdict {
  double tolerance = 0;
  /// Of |distance|, over all samples and all vertices of faces; infinite if one of them has no value.
  double largest = 0;
  /// Fraction of the area, in [0, 1], of texels whose |distance| exceeds the tolerance by more than the error
  /// of the engine, or that have no value.
  double exceeded_area_fraction = 0;
  bool within = true;  ///< largest ≤ tolerance, but for the error of the engine
  /// The verdict holds for the whole surface. If within: largest + error_bound ≤ tolerance, since distances
  /// are 1-Lipschitz. Always true otherwise, as one sample or vertex is enough to exceed a tolerance.
  bool certified = true;
};

/// `vertex_distances`: the distance at each vertex of surface.mesh(), NaN if it has no value. `accuracy`:
/// the error of a distance, as of engine_accuracy(): rounding exceeds no tolerance. `error_bound`: upper
/// bound on how much |distance| at any point of the surface can exceed the largest at samples and vertices,
/// as of SamplingBound::value(), without that error. Throws sdm::Error if the map or the distances belong to
/// another surface. Cost: linear in texels and faces.
[[nodiscard]] SDM_API ToleranceVerdict check_tolerance(const Surface& surface, const DistanceMap& map,
                                                       std::span<const float> vertex_distances,
                                                       double error_bound, double accuracy, double tolerance);

/// Returns an upper bound on the error of any distance that the engine computes from points of `on` to `to`,
/// in units of the meshes, including the rounding to float: EngineInfo::relative_error times the diagonal of
/// the bounding box of both meshes. Cost: linear.
[[nodiscard]] SDM_API double engine_accuracy(const EngineInfo& engine, const Mesh& on, const Mesh& to);

}  // namespace sdm

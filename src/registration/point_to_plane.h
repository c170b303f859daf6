// Steps of point-to-plane registration.
//
// A small motion with the rotation vector ω about the centre c and the translation τ moves a sample x along
// the normal n at its closest point by n·(ω × (x − c) + τ) = j·u, with
//
//     u = (ρ ω, τ),    j = ((x − c) × n / ρ, n).
//
// A step minimises Σ (r + j·u)² over the samples with a weight, with r the distance to the tangent plane.
#pragma once

#include "registration/correspondences.h"
#include "registration/eigen.h"

namespace sdm::registration {

/// Whether a sample is usable, and within `cut` of O2.
[[nodiscard]] bool has_weight(const Correspondences& pairs, std::size_t i, double cut);

/// The j of a sample.
[[nodiscard]] Motion normal_motion(const Vec3& point, const Vec3& normal, const Pivot& pivot);

/// The mean of j jᵀ over the usable samples within `cut` of O2, for the given normals.
[[nodiscard]] Matrix6 information(const Correspondences& pairs, std::span<const Vec3> normals,
                                  const Pivot& pivot, double cut);

/// The distance within which samples have a weight: three times the robust standard deviation, and more if
/// that keeps less than a quarter of the information about one of the `motions`.
[[nodiscard]] double trimming_cut(const Correspondences& pairs, const Pivot& pivot, const Motions& motions);

/// The solution u of matrix u = right in the span of `motions`, for a matrix without negative eigenvalues.
[[nodiscard]] Motion solved_within(const Matrix6& matrix, const Motions& motions, const Motion& right);

/// The minimising motion in the span of `motions`.
[[nodiscard]] Motion best_motion(const Correspondences& pairs, const Pivot& pivot, const Motions& motions,
                                 double cut);

/// The pose moved by `motion`.
[[nodiscard]] Affine moved(const Affine& pose, const Pivot& pivot, const Motion& motion);

}  // namespace sdm::registration

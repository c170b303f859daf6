/// The Hausdorff distance of two surfaces, with certified bounds.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>

namespace sdm {

/// Options of one_sided_hausdorff() and symmetric_hausdorff().
struct HausdorffOptions {
  /// The bounds are at most this far apart, by default kPrecision of the diagonal of the box of both meshes;
  /// > 0, in units of the meshes. At least 1e-12 of the diagonal and of the largest coordinate is used:
  /// rounding permits no less.
  std::optional<double> precision{};
  static constexpr double kPrecision = 1e-6;
  /// An angle in degrees, above 0 and at most 180: points are measured only to the closed faces of the other
  /// surface whose normal is within this angle of that of their own face; at 90 less than that. Without it,
  /// to all. Normals are outward of closed, orientable meshes, otherwise by the order of corners; allowed is
  /// what closest_facing_points() allows, decided in double precision.
  std::optional<double> facing{};
  Progress progress{};
};

template <>
inline constexpr auto kOptions<HausdorffOptions> = std::tuple{
    Option{
        .name = "precision",
        .member = &HausdorffOptions::precision,
        .text = "Bounds at most this far apart; by default 1e-6 of the diagonal of the box of both meshes.",
        .range = kPositive,
        .unit = "length",
        .value = "EPS"},
    facing_option<HausdorffOptions>()};

/// The largest distance from a point of a surface A to the closest point of a surface B.
struct HausdorffDistance {
  /// lower ≤ truth ≤ upper, rounding included. `value` is the distance of the witness: a point of A, and a
  /// closest point of B; equal to `lower` up to rounding. `exact` if the bounds differ by rounding only, at
  /// most 1e-12 of the diagonal of the box of both meshes.
  BoundedLength distance{};
  std::array<std::uint32_t, 2> faces{kNone, kNone};  ///< a face of A and one of B that contain the witness
  /// Set with HausdorffOptions::facing: the number of faces of A that have an area, but no allowed face of B,
  /// and their share of A's area, in [0, 1]. They have no distance, and are left out.
  std::size_t faces_without_match = 0;
  double area_without_match = 0;
};

template <>
inline constexpr std::tuple kFields<HausdorffDistance>{
    Field{"distance", &HausdorffDistance::distance, "The distance, with its witness."},
    Field{"faces", &HausdorffDistance::faces, "The faces that contain the points of the witness."},
    Field{"faces_without_match", &HausdorffDistance::faces_without_match,
          "The number of faces that no face of the other surface faces: they are left out."},
    Field{"area_without_match", &HausdorffDistance::area_without_match,
          "The fraction of the area that these have."}};

/// Distances in both directions; the symmetric Hausdorff distance is the larger one.
struct SymmetricHausdorff {
  std::array<HausdorffDistance, 2> from{};  ///< from A to B, from B to A
  /// Bounds on the larger one, and the witness of the direction with the larger lower bound, which starts on
  /// that surface.
  HausdorffDistance larger{};
  int larger_from = 0;  ///< the direction that `larger` has its witness from
};

/// Returns the one-sided Hausdorff distance, the maximum of d(p, B) over all points p of A, which is 0 if and
/// only if A is part of B. It is not symmetric. A is any triangle soup; faces that repeat a corner are
/// ignored, as Sites does, while other faces without area have edges and vertices.
///
/// Nothing is sampled: the surface is searched by branch and bound until the bounds are as close as the
/// options ask. Where triangles would have to be divided beyond the precision of double, the bounds stay
/// farther apart. The result does not depend on the number of threads.
///
/// With options.facing, the largest distance of a point of any face of A to the faces of B that are allowed
/// for that face. Faces of A without area have no normal, and are left out. As fewer faces are allowed, it is
/// never smaller, and not 0 for a surface with sharp folds to one with the same points but other faces.
///
/// Throws sdm::Error if A is unusable (see validate), for a precision that is not positive, an angle out of
/// range or one that leaves no face of A with a match, or if there is not enough memory; Cancelled. Cost:
/// sorting the vertices of A in space, and one search for each of those near which the maximum may lie, at
/// most all of them; then some searches for each doubling of the precision; with options.facing, up to three
/// for each face of A. More where the largest distance is attained, nearly, on a large part of the surface.
[[nodiscard]] SDM_API HausdorffDistance one_sided_hausdorff(const Mesh& a, const Sites& b,
                                                            const HausdorffOptions& options = {});

/// Returns both one-sided distances and the symmetric Hausdorff distance. Errors and cost as above, for each
/// direction.
[[nodiscard]] SDM_API SymmetricHausdorff symmetric_hausdorff(const Sites& a, const Sites& b,
                                                             const HausdorffOptions& options = {});

}  // namespace sdm

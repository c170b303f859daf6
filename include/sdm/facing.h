/// Closest points among the faces of O2 that face the same way as the query: they do not find the other skin
/// of a thin wall, so that a dent deeper than half of the wall is not hidden by it.
///
/// The direction of a sample of a surface is the outward normal of its face. A face so low that noise turns
/// it over (its least height is below 1/1000 of the diagonal of the surface's box) has that of its
/// surroundings instead, if these do not face as it does, within the angle: the sum of the normals of the
/// other faces at its corners, weighted by their areas, of which no more than half cancel out, and which are
/// at least twice that of the face. Maps, distances at vertices, proofs and the Hausdorff distance all have
/// this rule.
///
/// Threads: the function may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/closest_points.h>
#include <sdm/sites.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm {

/// What is found for each query, in its order.
struct FacingPoints {
  std::vector<ClosestPoint> closest;  ///< `face` is an allowed one
  /// 1 where the query q is behind its match: (q − c)·n < 0, with c the closest point and n the normal of the
  /// matched face. Where c lies on several allowed faces, n is their sum, at a vertex weighted by their
  /// angles.
  std::vector<std::uint8_t> behind;
  /// 1 where no face of O2 is allowed, at any distance: there is no closest point.
  std::vector<std::uint8_t> unmatched;
};

/// Returns the closest point of O2 to each of `points` among the closed faces that its normal allows, which
/// is the normal of the sample's surface and may have any length. `facing`: an angle in degrees, above 0 and
/// up to 180.
///
/// Allowed are the faces whose normal, oriented as Sites orients them (outwards if O2 is closed), is within
/// this angle of the query's: n·m ≥ cos(angle), to 1e-12; at 90° exactly, n·m > 0, so that faces
/// at a right angle are not allowed. Faces without area, or so thin that their normals are rounding, have
/// none and are never allowed; a normal of the query that is 0 or not finite allows none. Where the closest
/// point of all of O2 lies on an allowed face, or on an edge or a vertex of one, it is the result; otherwise
/// the first of equally close faces, in double precision.
///
/// Throws sdm::Error as closest_points() does, for an angle out of range, and unless there is a normal for
/// each point; Cancelled. Cost: linear
/// in the faces of O2, that of closest_points(), and another search for each point whose closest point is not
/// allowed.
[[nodiscard]] SDM_API FacingPoints closest_facing_points(const Sites& sites, std::span<const Vec3> points,
                                                         std::span<const Vec3> normals, double facing,
                                                         const ClosestPointOptions& options = {});

}  // namespace sdm

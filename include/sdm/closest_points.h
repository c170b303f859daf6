/// Closest points of O2 to arbitrary points: to all of O2, to the faces that face the same way, and to the
/// parts of an O2 that is too large for one machine.
///
/// Among the faces that face the same way as the query, the other skin of a thin wall is never the closest:
/// a dent deeper than half of the wall is measured to its own skin.
/// The direction of a sample of a surface is the outward normal of its face. A face so low that noise turns
/// it over (its least height is below 1/1000 of the diagonal of the surface's box) has that of its
/// surroundings instead, if these do not face as it does, within the angle: the sum of the normals of the
/// other faces at its corners, weighted by their areas, of which no more than half cancel out, and which are
/// at least twice that of the face. Maps, distances at vertices, proofs and the Hausdorff distance all have
/// this rule.
///
/// Threads: the functions may be called concurrently, also with the same Sites, on different results.
#pragma once

#include <sdm/engine.h>
#include <sdm/execution.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// Options of closest_points() and closest_facing_points().
struct ClosestPointOptions {
  std::shared_ptr<const Engine> engine{};  ///< null: the cpu engine
  /// Greater than 0, in units of the meshes. Points farther than this have no site (SiteType::none).
  double max_distance = kInfinity;
  Progress progress{};
};

template <>
inline constexpr auto kOptions<ClosestPointOptions> =
    std::tuple{max_distance_option<ClosestPointOptions>("Points farther than this have no site.")};

/// Returns the closest point of O2 to each of `points`, which may be in any order; `distance` is unsigned.
/// Throws sdm::Error for a coordinate that is NaN or beyond 1e37, for a max_distance that is not positive,
/// for an engine that takes no points (EngineInfo::takes_points), or if there is not enough memory;
/// Cancelled.
///
/// Of fewer than 8,192 points, the result of each is the closest point to rounding in double precision, and
/// does not depend on the others. From there on, points that lie much closer together than the faces are
/// searched in groups by the engine `cpu`: a point may then be farther than the closest one by at most
/// EngineInfo::relative_error, 1e-6, of the diagonal of O2 and the points, and depends on the others by as
/// much. Calls with fewer points each, or the engine `reference`, do without. Cost: sorting the points in
/// space, and one search per point by the engine.
[[nodiscard]] SDM_API std::vector<ClosestPoint> closest_points(const Sites& sites,
                                                               std::span<const Vec3> points,
                                                               const ClosestPointOptions& options = {});

/// Returns the closest point to `query` on a face of this site, which must be a closest site of `query`, as
/// maps and closest_points() have it, with weights that are not negative; no face for SiteType::none. Throws
/// sdm::Error if there is no such site. Cost: constant.
[[nodiscard]] SDM_API SurfacePoint point_on_face(const Sites& sites, SiteType type, std::uint32_t site,
                                                 const Vec3& query);

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
/// each point; Cancelled. Cost: linear in the faces of O2, that of closest_points(), and another search for
/// each point whose closest point is not allowed.
[[nodiscard]] SDM_API FacingPoints closest_facing_points(const Sites& sites, std::span<const Vec3> points,
                                                         std::span<const Vec3> normals, double facing,
                                                         const ClosestPointOptions& options = {});

/// The closest point of the parts merged so far to a query.
struct ClosestInParts {
  double distance = kInfinity;  ///< ≥ 0, = |vector|
  Vec3 vector{};                ///< closest point − query
  std::uint32_t site = kNone;   ///< its number in the whole O2
  std::uint32_t face = kNone;   ///< the face it was computed from
  SiteType type = SiteType::none;
};

/// The numbers that the vertices, edges and faces of a part have in the whole O2. Each list must increase, so
/// that the part and the whole agree on which of two sites is first.
struct PartNumbers {
  std::span<const std::uint32_t> vertices, edges, faces;
};

/// Options of merge_closest().
struct MergeClosestOptions {
  Progress progress{};
};

/// Replaces each entry of `best` by the closest point of `part` to its query, where that is closer: smaller
/// by (distance, type, site, face), in double precision. An entry's own distance limits its search, also
/// before the first part, where its type is none.
///
/// A face has the same distance in any part, and the minimum is taken over all faces, so the result depends
/// neither on how O2 is divided nor on the order of the parts: it is that of the reference engine for the
/// whole O2, bit for bit. Each face must be in a part; duplicate faces must be in the same one.
///
/// Throws sdm::Error if the numbers do not fit the part, if there are not as many results as queries, for a
/// coordinate that is NaN or beyond 1e37, or if there is not enough memory; Cancelled. `best` is then
/// unspecified. Cost: one search of the cpu engine per query, and a short one in double precision.
SDM_API void merge_closest(const Sites& part, const PartNumbers& numbers, std::span<const Vec3> queries,
                           std::span<ClosestInParts> best, const MergeClosestOptions& options = {});

}  // namespace sdm

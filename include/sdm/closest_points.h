/// Closest points of O2 to arbitrary points.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/engine.h>
#include <sdm/options.h>
#include <sdm/progress.h>
#include <sdm/sites.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// Options of closest_points() and closest_facing_points().
struct ClosestPointOptions {
  std::shared_ptr<const Engine> engine{};  ///< null: the cpu engine
  /// Greater than 0, in units of the meshes. Points farther than this have no site (SiteType::none).
  double max_distance = std::numeric_limits<double>::infinity();
  Progress progress{};
};

template <>
inline constexpr auto kOptions<ClosestPointOptions> =
    std::tuple{Option{.name = "max_distance",
                      .member = &ClosestPointOptions::max_distance,
                      .text = "Points farther than this have no site.",
                      .range = kPositiveOrInfinite,
                      .unit = "length",
                      .value = "D"}};

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

}  // namespace sdm

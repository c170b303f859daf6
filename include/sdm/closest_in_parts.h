/// Closest points of an O2 that is too large for one machine: the best of its parts.
///
/// Threads: the functions may be called concurrently, with the same Sites, on different results.
#pragma once

#include <sdm/api.h>
#include <sdm/progress.h>
#include <sdm/sites.h>

#include <cstdint>
#include <limits>
#include <span>

namespace sdm {

/// The closest point of the parts merged so far to a query.
struct ClosestInParts {
  double distance = std::numeric_limits<double>::infinity();  ///< ≥ 0, = |vector|
  Vec3 vector{};                                              ///< closest point − query
  std::uint32_t site = kNone;                                 ///< its number in the whole O2
  std::uint32_t face = kNone;                                 ///< the face it was computed from
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

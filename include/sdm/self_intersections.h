/// Whether a mesh intersects itself.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/api.h>
#include <sdm/progress.h>
#include <sdm/sites.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sdm {

/// Options of self_intersections() and is_embedded().
struct SelfIntersectionOptions {
  Progress progress{};
};

/// Returns the pairs of faces that have a point in common beyond the corners and edges that they share, each
/// once, the smaller face first, in lexicographic order. Empty for an embedded mesh. Touching counts; faces
/// without area and duplicate faces do not. Exact, for coordinates as they are. Throws Cancelled, and
/// sdm::Error if there is not enough memory. Cost: O(n log n) for n faces, plus linear in the
/// pairs of faces whose boxes overlap, of faces at one vertex or edge their directions from it; all cores.
[[nodiscard]] SDM_API std::vector<std::array<std::uint32_t, 2>> self_intersections(
    const Sites& sites, const SelfIntersectionOptions& options = {});

/// What was found within a budget.
struct SelfIntersections {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  bool all = true;  ///< otherwise, there may be others
};

/// The same, of `most` pairs of faces that come so near each other that they must be tested: in the plane, or
/// where needles cross, all pairs may. Which ones does not depend on the number of threads.
[[nodiscard]] SDM_API SelfIntersections self_intersections(const Sites& sites, std::uint64_t most,
                                                           const SelfIntersectionOptions& options = {});

/// A number of pairs that takes a second or, of large meshes, seconds, and far more than usual meshes have:
/// 200 for each face, at least 2 million.
[[nodiscard]] SDM_API std::uint64_t self_intersection_budget(const Sites& sites);

/// Whether there are none. Stops at the first one.
[[nodiscard]] SDM_API bool is_embedded(const Sites& sites, const SelfIntersectionOptions& options = {});

}  // namespace sdm

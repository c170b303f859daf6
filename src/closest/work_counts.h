// Work counters of the search for groups of points, which do not depend on the machine's speed. Only builds
// with -DSDM_COUNT_WORK=ON have them, for bench/compare; in others they cost nothing.
#pragma once

#include <cstddef>

namespace sdm::closest {

struct WorkCounts {
  std::size_t groups = 0;       ///< groups of points for which the tree was traversed
  std::size_t nodes = 0;        ///< tree nodes visited
  std::size_t leaves = 0;       ///< tree leaves whose face bounds were tested
  std::size_t gathered = 0;     ///< sites that passed these bounds and were collected from the leaves
  std::size_t list_blocks = 0;  ///< blocks of eight sites filtered for a smaller ball
  std::size_t evaluations = 0;  ///< pairs of a site and a packet whose distances were computed
};

#ifdef SDM_COUNT_WORK
inline constexpr bool kCountWork = true;
#else
inline constexpr bool kCountWork = false;
#endif

/// The counts of the calling thread since it started or last reset them by assignment.
inline WorkCounts& work_counts() {
  thread_local WorkCounts counts;
  return counts;
}

/// Adds to one of the thread's counts, in builds that count.
inline void count_work(std::size_t WorkCounts::*counter, std::size_t amount = 1) {
  if constexpr (kCountWork) work_counts().*counter += amount;
}

}  // namespace sdm::closest

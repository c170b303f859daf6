// Statistics of the cpu engine's search: counts of the work that it does, which do not depend on the
// machine's speed. Only builds with -DSDM_COUNT_WORK=ON have them, as those of bench/ablation; others count
// nothing, at no cost.
#pragma once

#include <cstddef>

namespace sdm::cpu {

struct WorkCounts {
  std::size_t groups = 0;       ///< groups of points for which the tree was traversed
  std::size_t nodes = 0;        ///< tree nodes visited
  std::size_t leaves = 0;       ///< tree leaves whose face bounds were tested
  std::size_t gathered = 0;     ///< sites that passed these bounds and were gathered from the leaves
  std::size_t list_blocks = 0;  ///< blocks of eight sites that were filtered for a smaller ball
  std::size_t evaluations = 0;  ///< pairs of a site and a packet for which distances were computed
};

#ifdef SDM_COUNT_WORK
inline constexpr bool kCountWork = true;
#else
inline constexpr bool kCountWork = false;
#endif

/// The counts of the calling thread, since it began or since they were reset by assignment.
inline WorkCounts& work_counts() {
  thread_local WorkCounts counts;
  return counts;
}

/// Adds to one of the thread's counts, in builds that count.
inline void count_work(std::size_t WorkCounts::*counter, std::size_t amount = 1) {
  if constexpr (kCountWork) work_counts().*counter += amount;
}

}  // namespace sdm::cpu

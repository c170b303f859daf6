// Checks of all items of a range.
#pragma once

#include <atomic>
#include <cstddef>

#include "core/parallel.h"

namespace sdm::core {

/// Whether valid(begin, end) for all disjoint ranges of at most about `grain` that cover [0, count), on all
/// cores.
template <class Valid>
bool parallel_all(std::size_t count, std::size_t grain, const Valid& valid) {
  std::atomic<bool> all{true};
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    if (!valid(begin, end)) all.store(false, std::memory_order_relaxed);
  });
  return all;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

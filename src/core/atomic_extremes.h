// Atomic maximum. The result does not depend on the order of the threads.
#pragma once

#include <atomic>

namespace sdm::core {

template <class T>
void atomic_max(T& largest, T value) {
  const std::atomic_ref<T> shared(largest);
  T current = shared.load(std::memory_order_relaxed);
  while (value > current && !shared.compare_exchange_weak(current, value, std::memory_order_relaxed)) {
  }
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

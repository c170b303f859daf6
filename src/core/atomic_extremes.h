// Atomic minimum and maximum. Results do not depend on the order of the threads.
#pragma once

#include <atomic>
#include <functional>

namespace sdm::core {

template <class T, class Better>
void atomic_best(T& best, T value, const Better& better) {
  const std::atomic_ref<T> shared(best);
  T current = shared.load(std::memory_order_relaxed);
  while (better(value, current) && !shared.compare_exchange_weak(current, value, std::memory_order_relaxed)) {
  }
}

template <class T>
void atomic_min(T& least, T value) {
  atomic_best(least, value, std::less<T>{});
}

template <class T>
void atomic_max(T& largest, T value) {
  atomic_best(largest, value, std::greater<T>{});
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

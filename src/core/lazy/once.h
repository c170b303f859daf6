// What is made at most once, by whichever thread needs it first.
#pragma once

#include <atomic>
#include <mutex>

#include "core/parallel.h"

namespace sdm::core {

/// As std::once_flag with std::call_once, which wait forever after an exception where they are those of GCC
/// for Windows (pthread_once of winpthreads).
class Once {
 public:
  /// Calls `make` unless an earlier call has returned; waits while another thread makes it. Throws what
  /// `make` throws, and the next call tries again. `make` must not call this again.
  template <class Function>
  void call(const Function& make) {
    if (made_.load(std::memory_order_acquire)) return;
    const std::lock_guard lock(mutex_);
    const Alone alone;
    if (made_.load(std::memory_order_relaxed)) return;
    make();
    made_.store(true, std::memory_order_release);
  }

 private:
  std::atomic<bool> made_{false};
  std::mutex mutex_;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

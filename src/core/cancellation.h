// Polls for cancellation. Parallel loops poll between their ranges; everything else that may take longer than
// some 20 ms polls by itself.
#pragma once

#include <atomic>
#include <cstdint>

namespace sdm::core {

/// The flag that calls on this thread obey, or null. Parallel loops hand it to the threads that work for
/// them.
struct CancelToken {
  const std::atomic<bool>* flag = nullptr;      ///< of a CancelScope
  const std::atomic<bool>* progress = nullptr;  ///< set once the progress callback has asked to cancel
};

[[nodiscard]] CancelToken cancel_token() noexcept;

/// Lets this thread obey a token until it is destroyed.
class CancelBy {
 public:
  explicit CancelBy(CancelToken token) noexcept;
  ~CancelBy();
  CancelBy(const CancelBy&) = delete;
  CancelBy& operator=(const CancelBy&) = delete;

 private:
  CancelToken outer_;
};

/// Lets what changes an object in place run to its end: no poll throws on this thread until it is destroyed.
class Uncancellable : CancelBy {
 public:
  Uncancellable() noexcept : CancelBy({}) {}
};

/// Throws Cancelled if this thread's work is to be cancelled. Cost: a few nanoseconds.
void poll();

/// Polls at every `stride`-th call, in the body of a loop.
class Poll {
 public:
  explicit Poll(std::uint32_t stride) : stride_(stride) {}
  void operator()() {
    if (++calls_ < stride_) return;
    calls_ = 0;
    poll();
  }

 private:
  std::uint32_t stride_, calls_ = 0;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

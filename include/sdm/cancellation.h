/// Cancellation of every call of the library, whether or not it reports progress.
///
/// Threads: a scope applies to the thread that made it, and to the threads that work for its calls.
#pragma once

#include <sdm/api.h>

#include <atomic>

namespace sdm {

/// During its lifetime, calls of the library by this thread end with sdm::Cancelled soon after `cancelled`
/// has become true, usually within 100 ms, also in loops that report no progress; a single sort, or the
/// release of much memory, is completed first. Calls that change an object in place (edits, refits, poses)
/// are completed first, so that no object is left half-changed. `cancelled` may be set by another thread or
/// by a signal handler, and must outlive the scope. Scopes nest: the innermost one alone applies, so one
/// whose flag is never set protects the calls inside it. Cost: none that can be measured.
class SDM_API CancelScope {
 public:
  /// Applies `cancelled` until the object is destroyed, on the same thread.
  explicit CancelScope(const std::atomic<bool>& cancelled) noexcept;
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const void* outer_;
};

}  // namespace sdm

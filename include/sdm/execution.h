/// How calls run: their progress, their cancellation, and the threads that they may use.
///
/// Threads: a CancelScope applies to the thread that made it, and to the threads that work for its calls.
/// Limits of threads may be set by several threads; the smallest of them is in force.
#pragma once

#include <sdm/types.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace sdm {

/// Called repeatedly, from one thread at a time, with the current step ("atlas", "map", ...) and the fraction
/// of it that is done, in [0, 1]. Return false to cancel: the computation then throws sdm::Cancelled. A
/// callback that makes an OpenGL context current must restore the previous one, which may be the gl engine's.
using Progress = std::function<bool(std::string_view step, double fraction)>;

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

/// During its lifetime, every function of the library uses at most `count` threads (0: all cores).
class SDM_API ThreadLimit {
 public:
  /// Sets the limit until the object is destroyed.
  explicit ThreadLimit(unsigned count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Runs independent tasks, concurrently if the limit allows. If one throws, tasks that have not started are
/// skipped, and its exception is rethrown once the running tasks have finished. A thread that waits, also
/// within a function of sdm that a task calls, may start another task: no task may call one while it holds a
/// lock that others need.
SDM_API void run_concurrently(const std::vector<std::function<void()>>& tasks);

}  // namespace sdm

/// The number of threads that the library may use.
///
/// Threads: limits may be set by several threads; the smallest of them is in force.
#pragma once

#include <sdm/api.h>

#include <functional>
#include <memory>
#include <vector>

namespace sdm {

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

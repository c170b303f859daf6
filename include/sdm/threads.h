/// The number of threads that the library may use.
#pragma once

#include <memory>

namespace sdm {

/// While it lives, every function of the library uses at most `count` threads (0: all cores).
class ThreadLimit {
 public:
  explicit ThreadLimit(unsigned count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm

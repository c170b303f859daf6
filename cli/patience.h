// What follows the results of a command, such as their text, while memory may be scarce.
#pragma once

#include <new>

/// Returns work(), which is called again while it lacks memory: it has freed some itself, and so may other
/// threads. Throws std::bad_alloc after many attempts.
template <class Work>
auto patiently(const Work& work) {
  constexpr int kAttempts = 200;
  for (int attempt = 1; attempt < kAttempts; ++attempt) try {
      return work();
    } catch (const std::bad_alloc&) {
    }
  return work();
}

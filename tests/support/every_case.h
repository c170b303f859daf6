// Comparisons with slow oracles: a fixed subset of the cases in ./check, all of them in `tests/long oracles`.
#pragma once

#include <cstddef>
#include <cstdlib>

namespace sdm::test {

/// Whether all cases are asked for (SDM_ALL_CASES).
inline bool every_case() {
  return std::getenv("SDM_ALL_CASES") != nullptr;
}

/// How many cases to compare: `all`, or the first `few` of them.
inline std::size_t subset(std::size_t few, std::size_t all) {
  return every_case() ? all : few;
}

/// The step from one compared case to the next: one, or `n`.
inline std::size_t stride(std::size_t n) {
  return every_case() ? 1 : n;
}

}  // namespace sdm::test

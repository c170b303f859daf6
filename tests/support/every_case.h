// Comparisons with slow oracles: a fixed subset of the cases in ./check, all of them in `tests/long oracles`.
#pragma once

#include <cstdlib>

namespace sdm::test {

/// Whether all cases are asked for (SDM_ALL_CASES).
inline bool every_case() {
  return std::getenv("SDM_ALL_CASES") != nullptr;
}

/// How many cases to compare: `all`, or the first `few` of them.
inline int cases(int few, int all) {
  return every_case() ? all : few;
}

}  // namespace sdm::test

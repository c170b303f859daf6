// The sets of vector instructions that this machine can run, to test each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sdm::test {

/// One set, by its bit in Highway's masks.
using SimdTarget = std::int64_t;
[[nodiscard]] std::vector<SimdTarget> simd_targets();
[[nodiscard]] std::string name(SimdTarget target);

/// During its lifetime the library uses this set only.
class UseSimdTarget {
 public:
  explicit UseSimdTarget(SimdTarget target);
  ~UseSimdTarget();
  UseSimdTarget(const UseSimdTarget&) = delete;
  UseSimdTarget& operator=(const UseSimdTarget&) = delete;
};

}  // namespace sdm::test

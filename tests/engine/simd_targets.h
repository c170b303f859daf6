// The sets of vector instructions that this machine can run, to test each.
#pragma once

#include <gtest/gtest.h>
#include <sdm/engine.h>

#include <cstdint>
#include <string>
#include <vector>

namespace sdm::test {

/// One set, by its bit in Highway's masks.
using SimdTarget = std::int64_t;
[[nodiscard]] std::vector<SimdTarget> simd_targets();
[[nodiscard]] std::string name(SimdTarget target);

/// While it lives, the library uses this set only.
class UseSimdTarget {
 public:
  explicit UseSimdTarget(SimdTarget target);
  ~UseSimdTarget();
  UseSimdTarget(const UseSimdTarget&) = delete;
  UseSimdTarget& operator=(const UseSimdTarget&) = delete;
};

/// The cpu engine on every set, and each other engine.
struct EngineOnTarget {
  std::string name;
  SimdTarget target;
};
void PrintTo(const EngineOnTarget& engine, std::ostream* out);
[[nodiscard]] std::vector<EngineOnTarget> engines_on_targets();
[[nodiscard]] std::string engine_on_target_name(const testing::TestParamInfo<EngineOnTarget>& parameter);

}  // namespace sdm::test

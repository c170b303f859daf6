// The engines to test, as parameters of tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/simd_targets.h"

namespace sdm::test {

/// Those of engines() that find closest points of any points, without gpu, whose results are those of
/// reference to the bit, but slow on a processor.
[[nodiscard]] std::vector<std::string> engine_names();
/// The same with gpu, if the build contains it: it is tested where it has a device (Debian:
/// mesa-vulkan-drivers).
[[nodiscard]] std::vector<std::string> engine_names_with_gpu();
[[nodiscard]] std::string engine_name(const testing::TestParamInfo<std::string>& parameter);

/// The cpu engine on every set, and each other engine.
struct EngineOnTarget {
  std::string name;
  SimdTarget target;
};
void PrintTo(const EngineOnTarget& engine, std::ostream* out);
[[nodiscard]] std::vector<EngineOnTarget> engines_on_targets();
[[nodiscard]] std::string engine_on_target_name(const testing::TestParamInfo<EngineOnTarget>& parameter);

}  // namespace sdm::test

#include "engine/simd_targets.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

#include <ostream>

#include "engine/support.h"

namespace sdm::test {

std::vector<SimdTarget> simd_targets() {
  std::vector<SimdTarget> targets;
  for (int bit = 0; bit < 63; ++bit)
    if (const SimdTarget target = SimdTarget{1} << bit; hwy::SupportedTargets() & HWY_TARGETS & target)
      targets.push_back(target);
  return targets;
}

std::string name(SimdTarget target) {
  return hwy::TargetName(target);
}

UseSimdTarget::UseSimdTarget(SimdTarget target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

UseSimdTarget::~UseSimdTarget() {
  hwy::SetSupportedTargetsForTest(0);  // what the machine has
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::vector<EngineOnTarget> engines_on_targets() {
  std::vector<EngineOnTarget> result;
  for (const std::string& engine : engine_names())
    if (engine != "cpu") result.push_back({engine, simd_targets().front()});
  for (const SimdTarget target : simd_targets()) result.push_back({"cpu", target});
  return result;
}

std::string engine_on_target_name(const testing::TestParamInfo<EngineOnTarget>& parameter) {
  const auto& [engine, target] = parameter.param;
  return engine == "cpu" ? engine + "_" + name(target) : engine;
}

void PrintTo(const EngineOnTarget& engine, std::ostream* out) {
  *out << engine.name << ' ' << name(engine.target);
}

}  // namespace sdm::test

#include "support/engines.h"

#include <sdm/engine.h>

#include <ostream>

namespace sdm::test {

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const EngineInfo& info : engines())
    if (info.takes_points && info.name != "gpu") names.emplace_back(info.name);
  return names;
}

std::vector<std::string> engine_names_with_gpu() {
  std::vector<std::string> names = engine_names();
  if (SDM_HAS_GPU) names.emplace_back("gpu");
  return names;
}

std::string engine_name(const testing::TestParamInfo<std::string>& parameter) {
  return parameter.param;
}

std::vector<EngineOnTarget> engines_on_targets() {
  std::vector<EngineOnTarget> result;
  for (const std::string& engine : engine_names_with_gpu())
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

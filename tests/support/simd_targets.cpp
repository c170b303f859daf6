#include "support/simd_targets.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

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

}  // namespace sdm::test

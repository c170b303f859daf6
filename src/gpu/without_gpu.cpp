// Replaces the gpu engine in builds without wgpu-native.
#include <sdm/error.h>

#include "gpu/gpu_engine.h"

namespace sdm::gpu {

std::shared_ptr<const Engine> make_gpu_engine(const GpuOptions&) {
  throw Error(
      "this sdm was built without wgpu-native (SDM_BUILD_GPU), which the gpu engine needs: use another "
      "engine");
}

std::optional<GpuReport> gpu_report(const Engine&) {
  return std::nullopt;
}

}  // namespace sdm::gpu

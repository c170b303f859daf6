// Replaces the gpu engine in builds without wgpu-native.
#include <sdm/error.h>
#include <sdm/gpu.h>

namespace sdm {
namespace {

[[noreturn]] void refuse() {
  throw Error(
      "this sdm was built without wgpu-native (SDM_BUILD_GPU), which the gpu engine needs: use another "
      "engine");
}

}  // namespace

std::vector<GpuDevice> gpu_devices() {
  refuse();
}

std::shared_ptr<const Engine> make_gpu_engine(const GpuOptions&) {
  refuse();
}

std::optional<GpuReport> gpu_report(const Engine&) {
  return std::nullopt;
}

}  // namespace sdm

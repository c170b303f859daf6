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

struct GpuMap::Impl {};

GpuMap::GpuMap(const Surface&, const Sites&, const GpuMapOptions&) {
  refuse();
}
GpuMap::~GpuMap() = default;
GpuMap::GpuMap(GpuMap&&) noexcept = default;
GpuMap& GpuMap::operator=(GpuMap&&) noexcept = default;

void GpuMap::compute(const Surface&, const Sites&) {
  refuse();
}

void GpuMap::compute(std::span<const Vec3>, const Sites&) {
  refuse();
}

void GpuMap::compute(std::span<const Vec3>, std::span<const Vec3>) {
  refuse();
}

std::size_t GpuMap::samples() const {
  refuse();
}

double GpuMap::error(double) const {
  refuse();
}

GpuMapStatistics GpuMap::statistics(double) const {
  refuse();
}

std::vector<float> GpuMap::distances() const {
  refuse();
}

GpuMapClosest GpuMap::closest() const {
  refuse();
}

}  // namespace sdm

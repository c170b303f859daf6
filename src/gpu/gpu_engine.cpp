#include "gpu/gpu_engine.h"

#include <mutex>
#include <utility>
#include <vector>

#include "core/lazy/device_pool.h"
#include "core/stopwatch.h"
#include "gpu/face_search.h"
#include "gpu/finish.h"

namespace sdm::gpu {
namespace {

// Never destroyed (see DevicePool).
DevicePool<FaceSearch>& devices() {
  static DevicePool<FaceSearch>& all = *new DevicePool<FaceSearch>;
  return all;
}

class GpuEngine final : public Engine {
 public:
  explicit GpuEngine(GpuOptions options) : options_(std::move(options)) {
    report_.device =
        devices().with(options_.device, [](FaceSearch& search, double) { return search.device().name(); });
  }

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }

  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const sites::ClosestSink& sink) const override {
    const sites::SitesData& data = internals(sites);
    thread_local std::vector<QueryPoint> placed;
    thread_local std::vector<FaceList> found;
    // Whole tiles: what fills the last one is skipped.
    placed.assign((points.size() + FaceSearch::kTile - 1) / FaceSearch::kTile * FaceSearch::kTile, {{}, -1});
    found.resize(placed.size());
    place_points(data, points, max_distance, placed);
    SearchTimes times;
    devices().with(options_.device,
                   [&](FaceSearch& search, double) { search.find(data, placed, found, times); });
    Stopwatch watch;
    const FinishCounts counts = finish(data, points, placed, found, max_distance, sink);
    add(points.size(), times, counts, watch.lap());
  }

  [[nodiscard]] GpuReport report() const {
    const std::lock_guard lock(mutex_);
    return report_;
  }

 private:
  void add(std::size_t points, const SearchTimes& times, const FinishCounts& counts, double finish_ms) const {
    const std::lock_guard lock(mutex_);
    report_.points += points;
    report_.nodes += counts.nodes;
    report_.tests += counts.tests;
    report_.candidates += counts.candidates;
    report_.incomplete += counts.incomplete;
    report_.dispatches += times.dispatches;
    report_.alone += counts.alone;
    report_.upload_ms += times.upload_ms;
    report_.search_ms += times.search_ms;
    report_.finish_ms += finish_ms;
  }

  const GpuOptions options_;
  mutable std::mutex mutex_;
  mutable GpuReport report_;
};

}  // namespace
}  // namespace sdm::gpu

namespace sdm {

std::vector<GpuDevice> gpu_devices() {
  return gpu::devices_by_preference();
}

std::shared_ptr<const Engine> make_gpu_engine(const GpuOptions& options) {
  return std::make_shared<const gpu::GpuEngine>(options);
}

std::optional<GpuReport> gpu_report(const Engine& engine) {
  const auto* gpu = dynamic_cast<const gpu::GpuEngine*>(&engine);
  if (gpu == nullptr) return std::nullopt;
  return gpu->report();
}

}  // namespace sdm

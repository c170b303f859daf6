#include "gpu/gpu_engine.h"

#include <algorithm>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "closest/blocks.h"
#include "closest/engine.h"
#include "core/lazy/device_pool.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "gpu/face_search.h"
#include "gpu/finish.h"
#include "sites/sites_data.h"
#include "surface/surface_data.h"

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

  // Searches in the largest blocks, which occupy a device; all cores place and finish the points of each,
  // while another one is searched.
  void map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
           const engine::SampleSink& sink) const override {
    constexpr std::size_t kBlock = closest::kLargestBlock, kRange = 64 * sites::ClosestPacket::kSize;
    const std::size_t count = surface.sample_texels().size();
    const auto search = [&](std::size_t begin) {
      std::vector<Vec3> points(std::min(kBlock, count - begin));
      parallel_for(points.size(), kRange, [&](std::size_t first, std::size_t last) {
        internals(surface).place_samples(begin + first, std::span(points).subspan(first, last - first));
      });
      Batch batch;
      find(sites, points, options.max_distance, batch);
      parallel_for((points.size() + kRange - 1) / kRange, 1, [&](std::size_t first, std::size_t last) {
        const std::size_t from = kRange * first, to = std::min(kRange * last, points.size());
        finish(sites, points, {from, to - from}, options.max_distance, batch,
               [&](std::size_t at, const sites::ClosestPacket& closest) {
                 sink(begin + at, std::span(points).subspan(at, closest.count), closest);
               });
      });
    };
    parallel_for((count + kBlock - 1) / kBlock, 1, options.progress, "map",
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t i = first; i < last; ++i) search(kBlock * i);
                 });
  }

  void closest_points(const Sites& sites, std::span<const Vec3> points, double max_distance,
                      const sites::ClosestSink& sink) const override {
    thread_local Batch batch;
    find(sites, points, max_distance, batch);
    finish(sites, points, {0, points.size()}, max_distance, batch, sink);
  }

  [[nodiscard]] GpuReport report() const {
    const std::lock_guard lock(mutex_);
    return report_;
  }

 private:
  struct Batch {
    std::vector<QueryPoint> placed;
    FaceLists found;
  };
  struct Range {
    std::size_t first, count;
  };

  void find(const Sites& sites, std::span<const Vec3> points, double max_distance, Batch& batch) const {
    const sites::SitesData& data = internals(sites);
    // Whole tiles: what fills the last one is skipped.
    batch.placed.assign((points.size() + FaceSearch::kTile - 1) / FaceSearch::kTile * FaceSearch::kTile,
                        {{}, -1});
    place_points(data, points, max_distance, batch.placed);
    SearchTimes times;
    devices().with(options_.device,
                   [&](FaceSearch& search, double) { search.find(data, batch.placed, batch.found, times); });
    const std::lock_guard lock(mutex_);
    report_.points += points.size();
    report_.dispatches += times.dispatches;
    report_.upload_ms += times.upload_ms;
    report_.search_ms += times.search_ms;
  }

  void finish(const Sites& sites, std::span<const Vec3> points, Range range, double max_distance,
              const Batch& batch, const sites::ClosestSink& sink) const {
    const auto part = [&](const auto& all) { return std::span(all).subspan(range.first, range.count); };
    Stopwatch watch;
    const FinishCounts counts = gpu::finish(
        internals(sites), part(points), part(batch.placed), batch.found, range.first, max_distance,
        [&](std::size_t first, const sites::ClosestPacket& closest) { sink(range.first + first, closest); });
    const double ms = watch.lap();
    const std::lock_guard lock(mutex_);
    report_.nodes += counts.nodes;
    report_.tests += counts.tests;
    report_.candidates += counts.candidates;
    report_.incomplete += counts.incomplete;
    report_.alone += counts.alone;
    report_.finish_ms += ms;
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

#include "gpu/gpu_engine.h"

#include <sdm/error.h>

#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "gpu/face_search.h"
#include "gpu/finish.h"

namespace sdm::gpu {
namespace {

// The open devices of the process by requested name, each used by one thread at a time. Never destroyed: at
// the end of a process drivers may be gone before it.
class DevicePool {
 public:
  template <class Use>
  auto with(const std::string& wanted, const Use& use) {
    const std::lock_guard lock(mutex_);
    const Alone alone;
    try {
      std::unique_ptr<FaceSearch>& open = open_[wanted];
      if (!open) open = std::make_unique<FaceSearch>(wanted);
      return use(*open);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error&) {
      open_.erase(wanted);  // it may be lost: the next call opens it anew
      throw;
    }
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::unique_ptr<FaceSearch>, std::less<>> open_;
};

DevicePool& devices() {
  static DevicePool& all = *new DevicePool;
  return all;
}

class GpuEngine final : public Engine {
 public:
  explicit GpuEngine(GpuOptions options) : options_(std::move(options)) {
    report_.device =
        devices().with(options_.device, [](FaceSearch& search) { return search.device().adapter().name; });
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
    devices().with(options_.device, [&](FaceSearch& search) { search.find(data, placed, found, times); });
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
    report_.far += counts.far;
    report_.incomplete += counts.incomplete;
    report_.dispatches += times.dispatches;
    report_.alone += times.alone;
    report_.upload_ms += times.upload_ms;
    report_.search_ms += times.search_ms;
    report_.finish_ms += finish_ms;
  }

  const GpuOptions options_;
  mutable std::mutex mutex_;
  mutable GpuReport report_;
};

}  // namespace

std::shared_ptr<const Engine> make_gpu_engine(const GpuOptions& options) {
  return std::make_shared<const GpuEngine>(options);
}

std::optional<GpuReport> gpu_report(const Engine& engine) {
  const auto* gpu = dynamic_cast<const GpuEngine*>(&engine);
  if (gpu == nullptr) return std::nullopt;
  return gpu->report();
}

}  // namespace sdm::gpu

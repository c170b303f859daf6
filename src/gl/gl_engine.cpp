#include "gl/gl_engine.h"

#include <sdm/error.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>

#include "closest/blocks.h"
#include "core/lazy/device_pool.h"
#include "core/stopwatch.h"
#include "gl/confirm.h"
#include "gl/device/context.h"
#include "gl/draw_winners.h"
#include "gl/raster_report.h"

namespace sdm {
namespace gl {
namespace {

struct Devices {
  DevicePool<RasterDevice> pool;
  TileTreeCache tiles;  // of the surfaces mapped on any of them
};

// Never destroyed (see DevicePool).
Devices& devices() {
  static Devices& all = *new Devices;
  return all;
}

// Draws the winners in single precision, then confirms them in double.
class GlEngine final : public Engine {
 public:
  explicit GlEngine(const GlOptions& options) : options_(options) { check_options(options_); }

  [[nodiscard]] const EngineInfo& info() const override { return kInfo; }
  void map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
           const engine::SampleSink& sink) const override;
  void closest_points(const Sites&, std::span<const Vec3>, double, const sites::ClosestSink&) const override {
    throw Error("the gl engine computes maps only: for closest points choose cpu or reference");
  }

  [[nodiscard]] std::optional<RasterReport> last_report() const {
    const std::lock_guard lock(mutex_);
    return last_report_;
  }

 private:
  const GlOptions options_;
  mutable std::mutex mutex_;
  mutable std::optional<RasterReport> last_report_;
};

void GlEngine::map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
                   const engine::SampleSink& sink) const {
  RasterReport report;
  const RasterWinners winners =
      devices().pool.with(options_.device, [&](const RasterDevice& device, double ms) {
        const Context::Current current(device.context());
        report.device = device.context().device();
        report.clip = options_.clip;
        report.texels = surface.owned_texels();
        report.time_ms.context = ms;
        return draw_winners(
            device, {surface, devices().tiles.of(surface), internals(sites), options_, options}, report);
      });

  Stopwatch watch;
  std::atomic<std::size_t> unconfirmed{0};
  closest::for_each_sample_block(
      surface, options.progress, "finish", [&](std::size_t begin, std::span<const Vec3> points) {
        const std::span<const std::uint32_t> texels = surface.sample_texels().subspan(begin, points.size());
        const auto pass = [&](std::size_t first, const sites::ClosestPacket& closest) {
          sink(begin + first, points.subspan(first, closest.count), closest);
        };
        unconfirmed += confirm(internals(sites), winners, texels, points, options.max_distance, pass);
      });
  report.unconfirmed = unconfirmed;
  report.time_ms.finish = watch.lap();
  const std::lock_guard lock(mutex_);
  last_report_ = std::move(report);
}

}  // namespace

}  // namespace gl

GlDevice gl_device(std::uint32_t resolution, const GlOptions& options) {
  check_options(options);
  return gl::devices().pool.with(options.device, [&](const gl::RasterDevice& device, double) {
    const gl::Context::Current current(device.context());
    gl::Rasteriser::check_size(device.context(), {resolution, resolution});
    return device.context().device();
  });
}

std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options) {
  return std::make_shared<const gl::GlEngine>(options);
}

std::optional<gl::RasterReport> gl::raster_report(const Engine& engine) {
  const auto* gl = dynamic_cast<const GlEngine*>(&engine);
  return gl ? gl->last_report() : std::nullopt;
}

std::optional<GlReport> gl_report(const Engine& engine) {
  const std::optional<gl::RasterReport> all = gl::raster_report(engine);
  if (!all) return {};
  GlReport result{.device = all->device,
                  .clip = all->clip,
                  .polygons = all->polygons,
                  .fragments = all->fragments,
                  .texels = all->texels,
                  .unconfirmed = all->unconfirmed};
  for (const auto& [name, count] : gl::kNamedCounts) result.counts.emplace_back(name, *all.*count);
  for (const auto& [name, time] : gl::kNamedTimes) result.time_ms.emplace_back(name, all->time_ms.*time);
  return result;
}

}  // namespace sdm

#include "gl/gl_engine.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

#include "core/stopwatch.h"
#include "engine/blocks.h"
#include "engine/cpu/cpu_engine.h"
#include "gl/draw_winners.h"
#include "sites/closest_on_face.h"

namespace sdm {
namespace gl {
namespace {

void check(const GlOptions& options) {
  if (options.stencil_values < 1 || options.stencil_values > 255)
    throw Error(std::to_string(options.stencil_values) + " stencil values are out of range; use 1 to 255");
}

// The process's devices, by requested name. One map is drawn at a time. They are never destroyed: at process
// exit, drivers may be gone before anything could be destroyed.
struct Devices {
  std::mutex drawing;
  std::map<std::string, std::unique_ptr<RasterDevice>, std::less<>> open;
  TileTreeCache tiles;  // of the surfaces mapped on any of them
  TileTreeCache whole_faces{true};
};

Devices& devices() {
  static Devices& all = *new Devices;
  return all;
}

// Calls use(device, ms) for the requested device, with its context current; ms is the time spent on opening
// it.
template <class Use>
auto with_device(const std::string& wanted, Use use) {
  Devices& all = devices();
  const std::lock_guard lock(all.drawing);
  Stopwatch watch;
  try {
    std::unique_ptr<RasterDevice>& device = all.open[wanted];
    if (!device) device = std::make_unique<RasterDevice>(wanted);
    const Context::Current current(device->context());
    return use(*device, watch.lap());
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    all.open.erase(wanted);  // it may be lost: the next map opens it anew
    throw;
  }
}

// Passes on the closest points of texels, in double, from their winners. Returns the number of texels whose
// winner was not confirmed; for these, the cpu engine found the closest site.
std::size_t confirm(const sites::SitesData& sites, const RasterWinners& winners,
                    std::span<const std::uint32_t> texels, std::span<const Vec3> points, double max_distance,
                    const engine::ClosestSink& sink) {
  std::size_t unconfirmed = 0;
  sites::ClosestPacket packet;
  for (std::size_t first = 0; first < texels.size(); first += packet.count) {
    packet.count = std::min(sites::ClosestPacket::kSize, texels.size() - first);
    for (std::size_t i = 0; i < packet.count; ++i) {
      const std::uint32_t texel = texels[first + i], face = winners.winners[texel];
      ClosestPoint closest;
      if (face != kNone) closest = sites::closest_around_face(sites, face, points[first + i]);
      const bool confirmed = face == kNone ? winners.complete : winners.confirms(texel, closest.distance);
      packet.set(i, points[first + i], closest.distance <= max_distance ? closest : ClosestPoint{});
      if (confirmed) continue;
      ++unconfirmed;
      cpu::cpu_search(sites, points.subspan(first + i, 1), max_distance,
                      [&](std::size_t, const sites::ClosestPacket& found) {
                        packet.set(i, points[first + i], found.get(0, points[first + i]));
                      });
    }
    sink(first, packet);
  }
  return unconfirmed;
}

// Passes on the distances and vectors that were drawn, as the paper does.
void pass_on(const RasterWinners& winners, std::span<const std::uint32_t> texels,
             std::span<const Vec3> points, double max_distance, const engine::ClosestSink& sink) {
  sites::ClosestPacket packet;
  for (std::size_t first = 0; first < texels.size(); first += packet.count) {
    packet.count = std::min(sites::ClosestPacket::kSize, texels.size() - first);
    for (std::size_t i = 0; i < packet.count; ++i) {
      const std::uint32_t texel = texels[first + i];
      const Vec3& point = points[first + i];
      ClosestPoint drawn;
      if (winners.winners[texel] != kNone) {
        std::tie(drawn.type, drawn.site) = site_of(winners.winners[texel]);
        const std::array<float, 4>& v = winners.vectors[texel];
        drawn.point = point + winners.depth_unit * Vec3{v[0], v[1], v[2]};
        drawn.distance = winners.depth_unit * static_cast<double>(winners.depths[texel]);
      }
      packet.set(i, point, drawn.distance <= max_distance ? drawn : ClosestPoint{});
    }
    sink(first, packet);
  }
}

// Draws the winners in single precision, then confirms them in double.
class GlEngine final : public Engine {
 public:
  GlEngine(const GlOptions& options, const Corrections& corrections)
      : options_(options), corrections_(corrections) {
    check(options_);
  }

  [[nodiscard]] const EngineInfo& info() const override {
    return corrections_.confirmation ? kInfo : kUnconfirmedInfo;
  }
  void map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
           const engine::SampleSink& sink) const override;
  void closest_points(const Sites&, std::span<const Vec3>, double,
                      const engine::ClosestSink&) const override {
    throw Error("the gl engine computes maps only: for closest points choose cpu or reference");
  }

  [[nodiscard]] std::optional<GlReport> last_report() const {
    const std::lock_guard lock(mutex_);
    return last_report_;
  }

 private:
  const GlOptions options_;
  const Corrections corrections_;
  mutable std::mutex mutex_;
  mutable std::optional<GlReport> last_report_;
};

void GlEngine::map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
                   const engine::SampleSink& sink) const {
  GlReport report;
  const RasterWinners winners = with_device(options_.device, [&](const RasterDevice& device, double ms) {
    report.device = device.context().device();
    report.clip = options_.clip;
    report.paper_literal = options_.paper_literal;
    report.texels = surface.sample_texels().size();
    report.time_ms.context = ms;
    TileTreeCache& trees = corrections_.tiles ? devices().tiles : devices().whole_faces;
    return draw_winners(
        device, {surface, trees.of(surface), internals(sites), options_, corrections_, options}, report);
  });

  Stopwatch watch;
  std::atomic<std::size_t> unconfirmed{0};
  engine::for_each_sample_block(
      surface, options.progress, "finish", [&](std::size_t begin, std::span<const Vec3> points) {
        const std::span<const std::uint32_t> texels = surface.sample_texels().subspan(begin, points.size());
        const auto pass = [&](std::size_t first, const sites::ClosestPacket& closest) {
          sink(begin + first, points.subspan(first, closest.count), closest);
        };
        if (corrections_.confirmation)
          unconfirmed += confirm(internals(sites), winners, texels, points, options.max_distance, pass);
        else
          pass_on(winners, texels, points, options.max_distance, pass);
      });
  report.unconfirmed = unconfirmed;
  report.time_ms.finish = watch.lap();
  const std::lock_guard lock(mutex_);
  last_report_ = std::move(report);
}

}  // namespace

std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options, const Corrections& corrections) {
  if (corrections.fragment_vectors && !corrections.affine_vectors)
    throw Error("fragments can evaluate affine vectors only");
  return std::make_shared<const GlEngine>(options, corrections);
}

}  // namespace gl

GlDevice gl_device(const GlOptions& options, std::uint32_t resolution) {
  gl::check(options);
  return gl::with_device(options.device, [&](const gl::RasterDevice& device, double) {
    gl::Rasteriser::check_size(device.context(), {resolution, resolution});
    return device.context().device();
  });
}

std::shared_ptr<const Engine> make_gl_engine(const GlOptions& options) {
  if (!options.paper_literal) return gl::make_gl_engine(options, gl::Corrections{});
  GlOptions literal = options;
  literal.clip = GlClip::stencil;
  return gl::make_gl_engine(literal, gl::Corrections::none());
}

std::optional<GlReport> gl_report(const Engine& engine) {
  const auto* gl = dynamic_cast<const gl::GlEngine*>(&engine);
  return gl ? gl->last_report() : std::nullopt;
}

}  // namespace sdm

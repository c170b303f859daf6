#include "research/literal/literal_engine.h"
#include "core/lazy/device_pool.h"
#include "gl/raster_report.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include "closest/blocks.h"
#include "closest/closest_points.h"
#include "core/stopwatch.h"
#include "gl/confirm.h"
#include "gl/device/context.h"
#include "gl/gl_engine.h"
#include "gl/map_drawing.h"
#include "research/literal/rasteriser.h"
#include "research/site_code.h"

namespace sdm::literal {
namespace {

constexpr EngineInfo kUnconfirmedInfo{.name = gl::kInfo.name,
                                      .summary = gl::kInfo.summary,
                                      .relative_error = std::numeric_limits<double>::infinity(),
                                      .takes_points = false};

struct Devices {
  DevicePool<Device> pool;
  gl::TileTreeCache tiles;
  gl::TileTreeCache whole_faces{1 << 16};  // texels: no map is larger
};

// Never destroyed (see DevicePool).
Devices& devices() {
  static Devices& all = *new Devices;
  return all;
}

struct Drawn : gl::RasterWinners {
  std::vector<std::array<float, 4>> vectors;  ///< the distance vectors drawn; empty with confirmation
};

// The corners of the faces in the atlas, if their triangles are drawn into the stencil.
std::vector<std::array<float, 2>> stencil_corners(const Surface& surface) {
  std::vector<std::array<float, 2>> corners;
  const Mesh& mesh = surface.mesh();
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    for (const std::uint32_t vertex : mesh.triangles[face]) {
      const bool mapped = surface.face_charts()[face] != kNone;
      const Vec2 uv = mapped ? surface.to_atlas(face, mesh.positions[vertex]) : Vec2{};
      corners.push_back({static_cast<float>(uv[0]), static_cast<float>(uv[1])});
    }
  return corners;
}

Drawn draw(const Device& device, const gl::DrawTask& task, const Corrections& corrections,
           gl::RasterReport& report) {
  gl::MapDrawing map(task, report);
  // Vectors to sites are longer beyond their regions: within a box, up to √3 times its reach, twice.
  const double longest = corrections.region_walls ? map.reach() : 4 * map.reach();
  const gl::RasterRules rules{map.slack(), gl::depth_scale(longest)};
  const std::vector<std::array<float, 2>> corners =
      corrections.stencil_points ? std::vector<std::array<float, 2>>() : stencil_corners(task.surface);
  const surface::Tiles& tiles = task.tile_tree.tiles;
  const Stencil stencil{{tiles.face_offsets, tiles.texels, task.gl.stencil_values}, corners};
  Stopwatch watch;
  Rasteriser rasteriser(device, {task.surface.resolution(), task.surface.rows()}, stencil, corrections);
  report.time_ms.draw = watch.lap();
  map.draw(PrintedPolygons{rules, map.reach(), corrections}, rasteriser);
  watch.lap();
  Image image = rasteriser.read_back();
  rasteriser.count_into(report);
  report.time_ms.read_back = watch.lap();
  Drawn drawn;
  drawn.winners = std::move(image.winners);
  drawn.depths = std::move(image.depths);
  drawn.vectors = std::move(image.vectors);
  drawn.complete = corrections.margins && corrections.stencil_points;
  drawn.depth_unit = 1 / rules.to_depth / task.sites.frame.scale;
  drawn.tolerance = 1.5 * rules.slack / task.sites.frame.scale;
  return drawn;
}

// Passes on the distances and vectors that were drawn, as the paper does.
void pass_on(const sites::SitesData& sites, const Drawn& winners, std::span<const std::uint32_t> texels,
             std::span<const Vec3> points, double max_distance, const sites::ClosestSink& sink) {
  sites::ClosestPacket packet;
  for (std::size_t first = 0; first < texels.size(); first += packet.count) {
    packet.count = std::min(sites::ClosestPacket::kSize, texels.size() - first);
    for (std::size_t i = 0; i < packet.count; ++i) {
      const std::uint32_t texel = texels[first + i];
      const Vec3& point = points[first + i];
      ClosestPoint drawn;
      if (texel >= winners.winners.size()) {  // a face without a texel
        closest::closest_points(sites, points.subspan(first + i, 1), max_distance,
                                [&](std::size_t, const sites::ClosestPacket& found) {
                                  packet.set(i, point, found.get(0, point));
                                });
        continue;
      }
      if (winners.winners[texel] != kNone) {
        std::tie(drawn.type, drawn.site) = research::site_of(winners.winners[texel]);
        const std::array<float, 4>& v = winners.vectors[texel];
        drawn.point = point + winners.depth_unit * Vec3{v[0], v[1], v[2]};
        drawn.distance = winners.depth_unit * static_cast<double>(winners.depths[texel]);
      }
      packet.set(i, point, drawn.distance <= max_distance ? drawn : ClosestPoint{});
    }
    sink(first, packet);
  }
}

class LiteralEngine final : public Engine {
 public:
  LiteralEngine(const GlOptions& options, const Corrections& corrections)
      : options_(options), corrections_(corrections) {
    options_.clip = GlClip::stencil;
  }

  [[nodiscard]] const EngineInfo& info() const override {
    return corrections_.confirmation ? gl::kInfo : kUnconfirmedInfo;
  }
  void map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
           const engine::SampleSink& sink) const override;
  void closest_points(const Sites&, std::span<const Vec3>, double, const sites::ClosestSink&) const override {
    throw Error("the paper's algorithm computes maps only");
  }

  [[nodiscard]] std::optional<gl::RasterReport> last_report() const {
    const std::lock_guard lock(mutex_);
    return last_report_;
  }

 private:
  GlOptions options_;
  Corrections corrections_;
  mutable std::mutex mutex_;
  mutable std::optional<gl::RasterReport> last_report_;
};

void LiteralEngine::map(const Surface& surface, const Sites& sites, const engine::EngineOptions& options,
                        const engine::SampleSink& sink) const {
  gl::RasterReport report;
  const Drawn drawn = devices().pool.with(options_.device, [&](const Device& device, double ms) {
    const gl::Context::Current current(device.context());
    report.device = device.context().device();
    report.clip = options_.clip;
    report.texels = surface.owned_texels();
    report.time_ms.context = ms;
    gl::TileTreeCache& trees = corrections_.tiles ? devices().tiles : devices().whole_faces;
    return draw(device, {surface, trees.of(surface), internals(sites), options_, options}, corrections_,
                report);
  });

  Stopwatch watch;
  std::atomic<std::size_t> unconfirmed{0};
  closest::for_each_sample_block(
      surface, options.progress, "finish", [&](std::size_t begin, std::span<const Vec3> points) {
        const std::span<const std::uint32_t> texels = surface.sample_texels().subspan(begin, points.size());
        const auto pass = [&](std::size_t first, const sites::ClosestPacket& closest) {
          sink(begin + first, points.subspan(first, closest.count), closest);
        };
        if (corrections_.confirmation)
          unconfirmed += gl::confirm(internals(sites), drawn, texels, points, options.max_distance, pass);
        else
          pass_on(internals(sites), drawn, texels, points, options.max_distance, pass);
      });
  report.unconfirmed = unconfirmed;
  report.time_ms.finish = watch.lap();
  const std::lock_guard lock(mutex_);
  last_report_ = std::move(report);
}

}  // namespace

std::shared_ptr<const Engine> make_engine(const GlOptions& options, const Corrections& corrections) {
  if (corrections.fragment_vectors && !corrections.affine_vectors)
    throw Error("fragments can evaluate affine vectors only");
  if (options.stencil_values < 1 || options.stencil_values > 255)
    throw Error("stencil values are out of range; use 1 to 255");
  return std::make_shared<const LiteralEngine>(options, corrections);
}

std::optional<gl::RasterReport> report(const Engine& engine) {
  const auto* literal = dynamic_cast<const LiteralEngine*>(&engine);
  return literal ? literal->last_report() : std::nullopt;
}

}  // namespace sdm::literal

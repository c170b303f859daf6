#include "proximity/bodies/nearest_body.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <string>
#include <utility>

#include "core/geometry/sweep.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "map/map_writer.h"
#include "surface/sample_blocks.h"
#include "surface/surface_data.h"

namespace sdm::bodies {
namespace {

// Finds the nearest bodies for the samples of a block; reuses its memory between blocks.
class BlockSearch {
 public:
  BlockSearch(std::span<const sampled::Body> bodies, std::size_t on, double max_distance)
      : bodies_(bodies), on_(on), max_distance_(max_distance) {}

  void find(std::span<const Vec3> points) {
    std::fill_n(closest_.begin(), points.size(), ClosestPoint{});
    std::fill_n(body_.begin(), points.size(), kNone);
    sort_bodies(points);
    for (const auto& [distance, body] : order_) {
      double farthest = 0;
      for (std::size_t i = 0; i < points.size(); ++i) farthest = std::max(farthest, limit(i));
      if (distance > farthest) break;
      search(points, body);
    }
  }
  [[nodiscard]] const ClosestPoint& closest(std::size_t i) const { return closest_[i]; }
  [[nodiscard]] std::uint32_t body(std::size_t i) const { return body_[i]; }

 private:
  // An upper bound on the result.
  [[nodiscard]] double limit(std::size_t i) const { return std::min(max_distance_, closest_[i].distance); }

  // Nearest box first: it most likely rules out the others.
  void sort_bodies(std::span<const Vec3> points) {
    Box box;
    for (const Vec3& p : points) extend(box, p);
    order_.clear();
    for (std::uint32_t b = 0; b < bodies_.size(); ++b)
      if (b != on_) order_.emplace_back(box_distance(box, bodies_[b].box()), b);
    std::ranges::sort(order_);
  }

  void search(std::span<const Vec3> points, std::uint32_t body) {
    std::size_t count = 0;
    double reach = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (box_distance({points[i], points[i]}, bodies_[body].box()) > limit(i)) continue;
      reach = std::max(reach, limit(i));
      asked_[count] = i;
      at_[count++] = points[i];
    }
    const auto keep_nearer = [&](std::size_t first, const sites::ClosestPacket& found) {
      for (std::size_t k = 0; k < found.count; ++k) {
        const std::uint32_t i = asked_[first + k];
        const ClosestPoint c = found.get(k, points[i]);
        if (c.type == SiteType::none) continue;
        if (std::pair(c.distance, body) < std::pair(closest_[i].distance, body_[i]))
          closest_[i] = c, body_[i] = body;
      }
    };
    cpu::cpu_search(internals(bodies_[body].sites()), std::span(at_).first(count), reach,
                    std::ref(keep_nearer));
  }

  std::span<const sampled::Body> bodies_;
  std::size_t on_;
  double max_distance_;
  std::vector<std::pair<double, std::uint32_t>> order_;  // distances of boxes from the samples, and bodies
  std::array<ClosestPoint, surface::kBlockSize> closest_;
  std::array<std::uint32_t, surface::kBlockSize> body_, asked_;
  std::array<Vec3, surface::kBlockSize> at_;  // positions of the samples in asked_
};

SignUsed signs_of_others(std::span<const sampled::Body> bodies, std::size_t on) {
  const auto solids = static_cast<std::size_t>(std::ranges::count_if(bodies, &sampled::Body::solid)) -
                      (bodies[on].solid() ? 1 : 0);
  return {solids > 0 ? SignMethod::exact : SignMethod::none, std::to_string(solids) + " of " +
                                                                 std::to_string(bodies.size() - 1) +
                                                                 " other bodies are closed and orientable"};
}

}  // namespace

void map_nearest(std::span<const sampled::Body> bodies, std::size_t on, double max_distance,
                 NearestMap& nearest) {
  const Surface& surface = bodies[on].surface();
  const std::span<const std::uint32_t> texels = surface.sample_texels();
  const map::MapWriter writer(nearest.map, surface);
  nearest.map.sign = signs_of_others(bodies, on);
  nearest.body.assign(surface.texel_faces().size(), kNone);
  std::atomic<std::size_t> beyond{0};
  constexpr std::size_t kGrain = 4;
  parallel_for(surface::block_count(texels.size()), kGrain, [&](std::size_t begin, std::size_t end) {
    BlockSearch search(bodies, on, max_distance);
    std::array<Vec3, surface::kBlockSize> places;
    sites::ClosestPacket packet;
    for (std::size_t b = begin; b < end; ++b) {
      const surface::SampleBlock block(b, texels.size());
      const std::span points = std::span(places).first(block.size());
      internals(surface).place_samples(block.first, points);
      search.find(points);
      for (std::size_t i = 0; i < points.size(); i += packet.count) {
        packet.count = std::min(sites::ClosestPacket::kSize, points.size() - i);
        std::uint32_t inside = 0;
        for (std::size_t k = 0; k < packet.count; ++k) {
          const ClosestPoint& c = search.closest(i + k);
          const std::uint32_t body = search.body(i + k);
          packet.set(k, points[i + k], c);
          if (body != kNone && bodies[body].inside()(points[i + k], c)) inside |= 1u << k;
          nearest.body[texels[block.first + i + k]] = body;
        }
        beyond += writer.store(block.first + i, packet, inside);
      }
    }
  });
  nearest.map.beyond_max_distance = beyond;
}

}  // namespace sdm::bodies

#include "bodies/many/nearest_body.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <string>
#include <utility>

#include "closest/closest_points.h"
#include "core/parallel.h"
#include "geometry/boxes.h"
#include "geometry/vec.h"
#include "map/map_writer.h"
#include "surface/sample_order.h"
#include "surface/surface_data.h"

namespace sdm::bodies {
namespace {

// Finds the nearest bodies for the samples of a block; reuses its memory between blocks.
class BlockSearch {
 public:
  BlockSearch(std::span<const shape::PosedBody> bodies, std::size_t on, double max_distance)
      : bodies_(bodies), on_(on), max_distance_(max_distance) {}

  void find(std::span<const Vec3> points) {
    std::fill_n(closest_.begin(), points.size(), ClosestPoint{});
    std::fill_n(distance_.begin(), points.size(), kInfinity);
    std::fill_n(body_.begin(), points.size(), kNone);
    sort_bodies(points);
    for (const auto& [distance, body] : order_) {
      double farthest = 0;
      for (std::size_t i = 0; i < points.size(); ++i) farthest = std::max(farthest, limit(i));
      if (distance > farthest) break;
      search(points, body);
    }
  }
  /// The body nearest to point i, or kNone.
  [[nodiscard]] std::uint32_t body(std::size_t i) const { return body_[i]; }
  /// Whether point i is inside it.
  [[nodiscard]] bool inside(std::size_t i) const {
    return body_[i] != kNone && bodies_[body_[i]].body().inside()(local_[i], closest_[i]);
  }
  /// Stores its closest point, in space.
  void store(std::size_t i, sites::ClosestPacket& packet, std::size_t lane) const {
    const ClosestPoint& c = closest_[i];
    packet.site[lane] = c.site;
    packet.type[lane] = c.type;
    if (body_[i] == kNone) return;
    const Vec3 vector = bodies_[body_[i]].pose().map.linear(c.point - local_[i]);
    for (int k = 0; k < 3; ++k) packet.vector[k][lane] = vector[k];
    packet.distance[lane] = distance_[i];
  }

 private:
  // An upper bound on the result.
  [[nodiscard]] double limit(std::size_t i) const { return std::min(max_distance_, distance_[i]); }

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
    const mesh::Similarity& pose = bodies_[body].pose();
    const Affine to_body = inverse(pose.map);
    std::size_t count = 0;
    double max_distance = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if (box_distance({points[i], points[i]}, bodies_[body].box()) > limit(i)) continue;
      max_distance = std::max(max_distance, limit(i));
      asked_[count] = i;
      at_[count++] = to_body(points[i]);
    }
    const auto keep_nearer = [&](std::size_t first, const sites::ClosestPacket& found) {
      for (std::size_t k = 0; k < found.count; ++k) {
        const std::uint32_t i = asked_[first + k];
        const ClosestPoint c = found.get(k, at_[first + k]);
        if (c.type == SiteType::none) continue;
        const double distance = pose.scale * c.distance;
        if (std::pair(distance, body) < std::pair(distance_[i], body_[i])) {
          closest_[i] = c;
          local_[i] = at_[first + k];
          distance_[i] = distance;
          body_[i] = body;
        }
      }
    };
    closest::closest_points(internals(bodies_[body].body().sites()), std::span(at_).first(count),
                            max_distance / pose.scale, std::ref(keep_nearer));
  }

  std::span<const shape::PosedBody> bodies_;
  std::size_t on_;
  double max_distance_;
  std::vector<std::pair<double, std::uint32_t>> order_;  // distances of boxes from the samples, and bodies
  // The distance of each point, in space, to the nearest body, that body, and, in the frame of that body,
  // the point itself and its closest point.
  std::array<double, surface::kBlockSize> distance_;
  std::array<std::uint32_t, surface::kBlockSize> body_;
  std::array<Vec3, surface::kBlockSize> local_;
  std::array<ClosestPoint, surface::kBlockSize> closest_;
  std::array<std::uint32_t, surface::kBlockSize> asked_;  // points for which a body is searched
  std::array<Vec3, surface::kBlockSize> at_;              // these in its frame
};

SignUsed signs_of_others(std::span<const shape::PosedBody> bodies, std::size_t on) {
  const auto solids = static_cast<std::size_t>(std::ranges::count_if(
                          bodies, [](const shape::PosedBody& body) { return body.body().solid(); })) -
                      (bodies[on].body().solid() ? 1 : 0);
  return {solids > 0 ? SignMethod::exact : SignMethod::none, std::to_string(solids) + " of " +
                                                                 std::to_string(bodies.size() - 1) +
                                                                 " other bodies are closed and orientable"};
}

}  // namespace

void require_meshes(std::span<const shape::PosedBody> bodies) {
  if (std::ranges::any_of(bodies, [](const shape::PosedBody& body) { return body.body().rounded(); }))
    throw Error("maps are to meshes, but a body is a primitive or has a margin; leave it out, or use meshes");
}

void map_nearest(std::span<const shape::PosedBody> bodies, std::size_t on, double max_distance,
                 NearestMap& nearest) {
  const Surface& surface = bodies[on].body().surface();
  require_meshes(bodies);
  const Affine& pose = bodies[on].pose().map;
  const std::span<const std::uint32_t> texels = surface.sample_texels();
  map::clear(nearest.map, surface);
  const map::MapWriter writer(nearest.map);
  nearest.map.sign = signs_of_others(bodies, on);
  nearest.body.assign(surface.map_faces().size(), kNone);
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
      for (Vec3& p : points) p = pose(p);
      search.find(points);
      for (std::size_t i = 0; i < points.size(); i += packet.count) {
        packet.count = std::min(sites::ClosestPacket::kSize, points.size() - i);
        std::uint32_t inside = 0;
        for (std::size_t k = 0; k < packet.count; ++k) {
          search.store(i + k, packet, k);
          if (search.inside(i + k)) inside |= 1u << k;
          nearest.body[texels[block.first + i + k]] = search.body(i + k);
        }
        beyond += writer.store(texels.subspan(block.first + i), packet, inside);
      }
    }
  });
  nearest.map.beyond_max_distance = beyond;
}

}  // namespace sdm::bodies

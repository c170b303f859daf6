#include "proximity/sampled/local_distances.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "surface/sample_blocks.h"
#include "surface/surface_data.h"

namespace sdm::sampled {
namespace {

// Calls take(index, signed distance) for each point; the points are in spatial order.
template <class Take>
void find_distances(const shape::Body& body, std::span<const Vec3> points, const Take& take) {
  const auto deliver = [&](std::size_t first, const sites::ClosestPacket& closest) {
    const std::uint32_t inside = body.inside()(points.subspan(first, closest.count), closest);
    for (std::size_t i = 0; i < closest.count; ++i)
      take(first + i, inside >> i & 1 ? -closest.distance[i] : closest.distance[i]);
  };
  cpu::cpu_search(internals(body.sites()), points, std::numeric_limits<double>::infinity(),
                  std::ref(deliver));
}

}  // namespace

void LocalDistances::start(const shape::Body& on, const shape::Body& to, const mesh::Similarity& pose) {
  on_ = &on, to_ = &to, pose_ = pose;
  on.require_pieces();
  probes_.assign(1, {.blocks = {0, surface::block_count(on.surface().sample_texels().size())}});
}

void LocalDistances::probe(std::size_t blocks_per_probe) {
  denser_.clear();
  for (const auto& [blocks, distance, radius] : probes_)
    for (std::size_t first = blocks.first; first < blocks.end; first += blocks_per_probe)
      denser_.push_back({.blocks = {first, std::min(first + blocks_per_probe, blocks.end)}});
  std::swap(probes_, denser_);

  const Surface& surface = on_->surface();
  const surface::PieceAssignment& pieces = on_->pieces();
  probe_points_.resize(probes_.size());
  constexpr std::size_t kGrain = 32;
  const auto probe_some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Probe& probe = probes_[i];
      Vec3& point = probe_points_[i];
      internals(surface).place_samples(probe.blocks.middle(surface.sample_texels().size()), {&point, 1});
      probe.radius = blocks_per_probe == 1 ? pieces.radius_about(surface, probe.blocks.first, point)
                                           : pieces.face_radius_about(surface, probe.blocks, point);
      probe.radius *= pose_.scale;
      point = pose_.map(point);
    }
    find_distances(*to_, std::span(probe_points_).subspan(begin, end - begin),
                   [&](std::size_t i, double distance) { probes_[begin + i].distance = distance; });
  };
  parallel_for(probes_.size(), kGrain, probe_some);
}

void LocalDistances::keep(double reach) {
  std::erase_if(probes_, [&](const Probe& probe) { return probe.least() > reach; });
}

void LocalDistances::measure() {
  const std::size_t samples = on_->surface().sample_texels().size();
  std::size_t count = 0;
  for (const Probe& probe : probes_) count += surface::SampleBlock(probe.blocks.first, samples).size();
  points_.resize(count), radii_.resize(count), distances_.resize(count);
  constexpr std::size_t kGrain = 16;
  const auto measure = [&](std::size_t begin, std::size_t end) {
    while (begin < end) {  // consecutive blocks share a search
      std::size_t next = begin + 1;
      while (next < end && probes_[next].blocks.first == probes_[next - 1].blocks.end) ++next;
      measure_blocks(begin, next);
      begin = next;
    }
  };
  parallel_for(probes_.size(), kGrain, measure);
}

void LocalDistances::measure_blocks(std::size_t begin, std::size_t end) {
  const Surface& surface = on_->surface();
  const surface::PieceAssignment& pieces = on_->pieces();
  const std::size_t first = begin * surface::kBlockSize,
                    last = std::min(end * surface::kBlockSize, points_.size());
  const std::span points = std::span(points_).subspan(first, last - first);
  internals(surface).place_samples(probes_[begin].blocks.first * surface::kBlockSize, points);
  for (std::size_t i = begin; i < end; ++i) {
    const surface::SampleBlock block(i, points_.size());
    pieces.measure_block(surface, probes_[i].blocks.first,
                         std::span(points_).subspan(block.first, block.size()),
                         std::span(radii_).subspan(block.first, block.size()));
  }
  for (Vec3& p : points) p = pose_.map(p);
  if (pose_.scale != 1)
    for (float& radius : std::span(radii_).subspan(first, last - first))
      radius = surface::rounded_up(pose_.scale * radius);
  find_distances(*to_, points, [&](std::size_t i, double distance) {
    distances_[first + i] = static_cast<float>(distance);
  });
}

std::size_t LocalDistances::sample(std::size_t i) const {
  return probes_[i / surface::kBlockSize].blocks.first * surface::kBlockSize + i % surface::kBlockSize;
}

}  // namespace sdm::sampled

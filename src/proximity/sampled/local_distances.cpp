#include "proximity/sampled/local_distances.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "surface/sample_blocks.h"
#include "surface/surface_data.h"

namespace sdm::sampled {
namespace {

// Calls take(index, signed distance, packet, lane) for each point; the points are in spatial order.
template <class Take>
void find_distances(const Body& body, std::span<const Vec3> points, const Take& take) {
  const auto deliver = [&](std::size_t first, const sites::ClosestPacket& closest) {
    const std::uint32_t inside = body.inside()(points.subspan(first, closest.count), closest);
    for (std::size_t i = 0; i < closest.count; ++i)
      take(first + i, inside >> i & 1 ? -closest.distance[i] : closest.distance[i], closest, i);
  };
  cpu::cpu_search(internals(body.sites()), points, std::numeric_limits<double>::infinity(),
                  std::ref(deliver));
}

}  // namespace

void LocalDistances::start(const Body& on, const Body& to, const proximity::Similarity& pose) {
  on_ = &on, to_ = &to, pose_ = pose;
  on.require_pieces();
  probes_.assign(1, {.blocks = {0, surface::block_count(on.surface().sample_texels().size())}});
  deepest_probed_ = 0;
}

void LocalDistances::probe(std::size_t blocks_per_probe) {
  denser_.clear();
  for (const Probe& probe : probes_)
    for (std::size_t first = probe.blocks.first; first < probe.blocks.end; first += blocks_per_probe)
      denser_.push_back(
          {.blocks = {first, std::min(first + blocks_per_probe, probe.blocks.end)}, .marked = probe.marked});
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
    const std::span points = std::span(probe_points_).subspan(begin, end - begin);
    find_distances(
        *to_, points,
        [&](std::size_t i, double distance, const sites::ClosestPacket& closest, std::size_t lane) {
          Probe& probe = probes_[begin + i];
          probe.distance = distance;
          probe.at_boundary = at_boundary(points[i], distance, closest, lane);
        });
  };
  parallel_for(probes_.size(), kGrain, probe_some);
  for (const Probe& probe : probes_) deepest_probed_ = std::max(deepest_probed_, -probe.distance);
}

// True for points outside.
bool LocalDistances::at_boundary(const Vec3& point, double distance, const sites::ClosestPacket& closest,
                                 std::size_t lane) const {
  return !(distance < 0) || to_->inside().at_boundary(point, closest.get(lane, point));
}

// The boundary is as far from the probe as its closest face, or from a probe outside no nearer. Where it may
// be farther, nothing is known.
void LocalDistances::mark_deeper(double depth) {
  for (Probe& probe : probes_) probe.marked = probe.marked && (!probe.at_boundary || -probe.least() > depth);
}

void LocalDistances::keep_marked() {
  std::erase_if(probes_, [](const Probe& probe) { return !probe.marked; });
}

void LocalDistances::keep(double reach) {
  std::erase_if(probes_, [&](const Probe& probe) { return probe.least() > reach; });
}

void LocalDistances::measure(double depth, Samples samples) {
  const std::size_t all = on_->surface().sample_texels().size();
  std::size_t count = 0;
  for (const Probe& probe : probes_) count += surface::SampleBlock(probe.blocks.first, all).size();
  points_.resize(count), radii_.resize(count), distances_.resize(count), at_boundary_.resize(count);
  packet_marked_.resize((count + kPacket - 1) / kPacket);
  constexpr std::size_t kGrain = 16;
  const auto measure = [&](std::size_t begin, std::size_t end) {
    while (begin < end) {  // consecutive blocks share a search
      std::size_t next = begin + 1;
      while (next < end && probes_[next].blocks.first == probes_[next - 1].blocks.end) ++next;
      measure_blocks(begin, next, depth, samples);
      begin = next;
    }
  };
  parallel_for(probes_.size(), kGrain, measure);
  buried_.clear();
  for (std::uint32_t i = 0; i < count; ++i)
    if (!at_boundary_[i] && marked(i)) buried_.push_back(i);
}

void LocalDistances::measure_blocks(std::size_t begin, std::size_t end, double depth, Samples samples) {
  place_blocks(begin, end);
  const std::size_t first = begin * surface::kBlockSize,
                    last = std::min(end * surface::kBlockSize, points_.size());
  const std::size_t first_packet = first / kPacket, last_packet = (last + kPacket - 1) / kPacket;
  thread_local std::vector<std::uint32_t> chosen;
  chosen.clear();
  if (samples == Samples::all) {
    for (std::size_t i = first; i < last; ++i) chosen.push_back(static_cast<std::uint32_t>(i));
    measure_samples(chosen);
    mark_packets(begin, end, depth);
    return;
  }
  std::fill(distances_.begin() + static_cast<std::ptrdiff_t>(first),
            distances_.begin() + static_cast<std::ptrdiff_t>(last), std::numeric_limits<float>::infinity());
  std::fill(at_boundary_.begin() + static_cast<std::ptrdiff_t>(first),
            at_boundary_.begin() + static_cast<std::ptrdiff_t>(last), std::uint8_t{1});
  for (std::size_t p = first_packet; p < last_packet; ++p)
    chosen.push_back(static_cast<std::uint32_t>(middle_of_packet(p)));
  measure_samples(chosen);
  mark_packets(begin, end, depth);
  chosen.clear();
  for (std::size_t p = first_packet; p < last_packet; ++p)
    for (std::size_t i = p * kPacket; i < std::min(last, (p + 1) * kPacket) && packet_marked_[p]; ++i)
      chosen.push_back(static_cast<std::uint32_t>(i));
  measure_samples(chosen);
}

// Sets the points and covering radii.
void LocalDistances::place_blocks(std::size_t begin, std::size_t end) {
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
}

void LocalDistances::measure_samples(std::span<const std::uint32_t> samples) {
  thread_local std::vector<Vec3> points;
  points.clear();
  for (const std::uint32_t i : samples) points.push_back(points_[i]);
  find_distances(*to_, points,
                 [&](std::size_t k, double distance, const sites::ClosestPacket& closest, std::size_t lane) {
                   const std::uint32_t i = samples[k];
                   distances_[i] = static_cast<float>(distance);
                   at_boundary_[i] = at_boundary(points_[i], distance, closest, lane);
                 });
}

// As mark_deeper does for blocks, by the distances at the middle of each packet, and where these are deeper,
// by them.
void LocalDistances::mark_packets(std::size_t begin, std::size_t end, double depth) {
  for (std::size_t b = begin; b < end; ++b) {
    const surface::SampleBlock block(b, points_.size());
    const std::size_t first = block.first / kPacket, last = (block.end + kPacket - 1) / kPacket;
    double deepest = depth;
    for (std::size_t p = first; p < last; ++p)
      deepest = std::max(deepest, -double{distances_[middle_of_packet(p)]});
    for (std::size_t p = first; p < last; ++p) {
      const std::size_t middle = middle_of_packet(p);
      double radius = 0;
      for (std::size_t i = p * kPacket; i < std::min(block.end, (p + 1) * kPacket); ++i)
        radius = std::max(radius, norm(points_[i] - points_[middle]) + radii_[i]);
      packet_marked_[p] =
          probes_[b].marked && (!at_boundary_[middle] || radius - distances_[middle] > deepest);
    }
  }
}

std::size_t LocalDistances::sample(std::size_t i) const {
  return probes_[i / surface::kBlockSize].blocks.first * surface::kBlockSize + i % surface::kBlockSize;
}

}  // namespace sdm::sampled

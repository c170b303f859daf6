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

// Calls take(index, signed distance) for each point, which are in spatial order.
template <class Take>
void find_distances(const Body& body, std::span<const Vec3> points, const Take& take) {
  const auto deliver = [&](std::size_t first, const sites::ClosestPacket& closest) {
    const std::uint32_t inside = body.inside()(points.subspan(first, closest.count), closest);
    for (std::size_t i = 0; i < closest.count; ++i)
      take(first + i, inside >> i & 1 ? -closest.distance[i] : closest.distance[i]);
  };
  cpu::cpu_search(internals(body.sites()), points, std::numeric_limits<double>::infinity(),
                  std::ref(deliver));
}

}  // namespace

void LocalDistances::start(const Body& on, const Body& to) {
  on_ = &on, to_ = &to;
  probes_.assign(1, {.runs = {0, surface::run_count(on.surface().sample_texels().size())}});
  least_probed_ = std::numeric_limits<double>::infinity();
}

void LocalDistances::probe(std::size_t runs_per_probe) {
  denser_.clear();
  for (const auto& [runs, distance, spread] : probes_)
    for (std::size_t first = runs.first; first < runs.end; first += runs_per_probe)
      denser_.push_back({.runs = {first, std::min(first + runs_per_probe, runs.end)}});
  std::swap(probes_, denser_);

  const Surface& surface = on_->surface();
  const surface::Coverage& coverage = surface::coverage_of(surface);
  probe_points_.resize(probes_.size());
  constexpr std::size_t kGrain = 32;
  const auto probe_some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Probe& probe = probes_[i];
      Vec3& point = probe_points_[i];
      surface::place_samples(internals(surface), probe.runs.middle(surface.sample_texels().size()),
                             {&point, 1});
      probe.spread = runs_per_probe == 1 ? coverage.spread(surface, probe.runs.first, point)
                                         : coverage.face_spread(surface, probe.runs, point);
    }
    find_distances(*to_, std::span(probe_points_).subspan(begin, end - begin),
                   [&](std::size_t i, double distance) { probes_[begin + i].distance = distance; });
  };
  parallel_for(probes_.size(), kGrain, probe_some);
  for (const Probe& probe : probes_) least_probed_ = std::min(least_probed_, std::abs(probe.distance));
}

void LocalDistances::keep(double reach) {
  std::erase_if(probes_, [&](const Probe& probe) { return probe.least() > reach; });
}

void LocalDistances::measure() {
  const std::size_t samples = on_->surface().sample_texels().size();
  std::size_t count = 0;
  for (const Probe& probe : probes_) count += surface::SampleBlock(probe.runs.first, samples).size();
  points_.resize(count), radii_.resize(count), distances_.resize(count);
  constexpr std::size_t kGrain = 16;
  const auto measure = [&](std::size_t begin, std::size_t end) {
    while (begin < end) {  // runs that follow each other share a search
      std::size_t next = begin + 1;
      while (next < end && probes_[next].runs.first == probes_[next - 1].runs.end) ++next;
      measure_runs(begin, next);
      begin = next;
    }
  };
  parallel_for(probes_.size(), kGrain, measure);
}

void LocalDistances::measure_runs(std::size_t begin, std::size_t end) {
  const Surface& surface = on_->surface();
  const surface::Coverage& coverage = surface::coverage_of(surface);
  const std::size_t first = begin * surface::kRunLength,
                    last = std::min(end * surface::kRunLength, points_.size());
  const std::span points = std::span(points_).subspan(first, last - first);
  surface::place_samples(internals(surface), probes_[begin].runs.first * surface::kRunLength, points);
  for (std::size_t i = begin; i < end; ++i) {
    const surface::SampleBlock run(i, points_.size());
    coverage.measure_run(surface, probes_[i].runs.first, std::span(points_).subspan(run.first, run.size()),
                         std::span(radii_).subspan(run.first, run.size()));
  }
  find_distances(*to_, points, [&](std::size_t i, double distance) {
    distances_[first + i] = static_cast<float>(distance);
  });
}

std::size_t LocalDistances::sample(std::size_t i) const {
  return probes_[i / surface::kRunLength].runs.first * surface::kRunLength + i % surface::kRunLength;
}

}  // namespace sdm::sampled

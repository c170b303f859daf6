#include "query/local_distances.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "atlas/sample_runs.h"
#include "atlas/surface_impl.h"
#include "core/parallel.h"
#include "engine/engine.h"

namespace sdm {
namespace {

// Calls take(index, signed distance) for each point, which are in spatial order.
template <class Take>
void find_distances(const Body& body, std::span<const Vec3> points, const Take& take) {
  const auto deliver = [&](std::size_t first, const ClosestPacket& closest) {
    for (std::size_t i = 0; i < closest.count; ++i) {
      const Vec3& query = points[first + i];
      const bool negative = body.inside()(query, closest.get(i, query));
      take(first + i, negative ? -closest.distance[i] : closest.distance[i]);
    }
  };
  cpu_search(body.sites().impl(), points, std::numeric_limits<double>::infinity(), std::ref(deliver));
}

}  // namespace

void LocalDistances::probe(const Body& on, const Body& to) {
  on_ = &on, to_ = &to;
  const Surface& surface = on.surface();
  const Coverage& coverage = coverage_of(surface);
  const std::size_t samples = surface.samples().size();
  probe_points_.resize(run_count(samples));
  probes_.resize(probe_points_.size());
  constexpr std::size_t kGrain = 64;
  const auto probe = [&](std::size_t begin, std::size_t end) {
    const std::span points = std::span(probe_points_).subspan(begin, end - begin);
    for (std::size_t r = begin; r < end; ++r) {
      const SampleRun run(r, samples);
      place_samples(surface.impl(), run.first + run.size() / 2, {&probe_points_[r], 1});
      probes_[r].spread = coverage.spread(surface, r, probe_points_[r]);
    }
    find_distances(to, points,
                   [&](std::size_t i, double distance) { probes_[begin + i].distance = distance; });
  };
  parallel_for(probes_.size(), kGrain, probe);
}

double LocalDistances::least_probed() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Probe& probe : probes_) least = std::min(least, std::abs(probe.distance));
  return least;
}

void LocalDistances::measure(double reach) {
  measured_.clear();
  for (std::size_t r = 0; r < probes_.size(); ++r)
    if (probes_[r].least() <= reach) measured_.push_back(r);
  const std::size_t samples = on_->surface().samples().size();
  std::size_t count = 0;
  for (const std::size_t r : measured_) count += SampleRun(r, samples).size();
  points_.resize(count), radii_.resize(count), distances_.resize(count);
  constexpr std::size_t kGrain = 16;
  const auto measure = [&](std::size_t begin, std::size_t end) {
    while (begin < end) {  // runs that follow each other share a search
      std::size_t next = begin + 1;
      while (next < end && measured_[next] == measured_[next - 1] + 1) ++next;
      measure_runs(begin, next);
      begin = next;
    }
  };
  parallel_for(measured_.size(), kGrain, measure);
}

void LocalDistances::measure_runs(std::size_t begin, std::size_t end) {
  const Surface& surface = on_->surface();
  const Coverage& coverage = coverage_of(surface);
  const std::size_t first = begin * kRunLength, last = std::min(end * kRunLength, points_.size());
  const std::span points = std::span(points_).subspan(first, last - first);
  place_samples(surface.impl(), measured_[begin] * kRunLength, points);
  for (std::size_t i = begin; i < end; ++i) {
    const SampleRun run(i, points_.size());
    coverage.measure_run(surface, measured_[i], std::span(points_).subspan(run.first, run.size()),
                         std::span(radii_).subspan(run.first, run.size()));
  }
  find_distances(*to_, points, [&](std::size_t i, double distance) {
    distances_[first + i] = static_cast<float>(distance);
  });
}

std::size_t LocalDistances::sample(std::size_t i) const {
  return measured_[i / kRunLength] * kRunLength + i % kRunLength;
}

}  // namespace sdm

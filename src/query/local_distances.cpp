#include "query/local_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/vec.h"
#include "engine/engine.h"

namespace sdm {
namespace {

constexpr std::size_t kRun = 256;  // a compact piece of the surface: see core/spatial_order.h
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

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
  cpu_search(body.sites().impl(), points, kNoLimit, std::ref(deliver));
}

}  // namespace

void LocalDistances::probe(const Body& on, const Body& to) {
  on_ = &on, to_ = &to;
  const std::span<const Vec3> points = on.surface().sample_points();
  const std::span<const float> radii = on.surface().sample_radii();
  distances_.resize(points.size());
  runs_.resize((points.size() + kRun - 1) / kRun);
  probes_.resize(runs_.size());
  constexpr std::size_t kGrain = 256;
  const auto probe = [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      Run& run = runs_[r];
      run = {.first = kRun * r, .end = std::min(points.size(), kRun * (r + 1))};
      probes_[r] = points[run.probe()];
      double squared = 0;
      float radius = 0;
      for (std::size_t i = run.first; i < run.end; ++i) {
        squared = std::max(squared, squared_norm(points[i] - probes_[r]));
        radius = std::max(radius, radii[i]);
      }
      run.spread = std::sqrt(squared) + radius;
    }
    find_distances(to, std::span(probes_).subspan(begin, end - begin),
                   [&](std::size_t i, double distance) { runs_[begin + i].distance = distance; });
  };
  parallel_for(runs_.size(), kGrain, std::ref(probe));
}

double LocalDistances::least_probed() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Run& run : runs_) least = std::min(least, std::abs(run.distance));
  return least;
}

void LocalDistances::measure(double reach) {
  measured_.clear();
  for (const Run& run : runs_)
    if (run.least() <= reach) measured_.push_back(run);
  const std::span<const Vec3> points = on_->surface().sample_points();
  constexpr std::size_t kGrain = 16;
  const auto measure = [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end;) {
      const std::size_t first = measured_[r].first;
      std::size_t last = measured_[r].end;  // runs that follow each other share a search
      for (++r; r < end && measured_[r].first == last; ++r) last = measured_[r].end;
      find_distances(*to_, points.subspan(first, last - first), [&](std::size_t i, double distance) {
        distances_[first + i] = static_cast<float>(distance);
      });
    }
  };
  parallel_for(measured_.size(), kGrain, std::ref(measure));
}

}  // namespace sdm

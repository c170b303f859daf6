#include "certify/metrics/estimate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/vertex_search.h"
#include "certify/metrics/intervals.h"
#include "certify/metrics/surface_points.h"
#include "closest/scattered.h"
#include "closest/single_point.h"
#include "core/cancellation.h"
#include "core/numbers/compensated_sum.h"
#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/triangle.h"

namespace sdm::metrics {
namespace {

// A number of both directions has four ends.
constexpr double kMiss = (1 - MetricsOptions::kConfidence) / 4;
// The upper end of a mean misses where the mean of usual distances or the share of larger ones does.
constexpr double kOfMean = 0.8 * kMiss, kOfShare = kMiss - kOfMean;
// The number of points is chosen by other points before: with those the intervals would be too narrow by
// choice. There are at least kFewPoints of either.
constexpr std::size_t kFewPoints = 256, kTrials = std::size_t{1} << 16, kOfTrials = 8;
// The largest distance is usually less than this many times that of all trials.
constexpr double kUsual = 1.25;
// Where no distance is so many times as large as their root mean square, those that are not found hardly
// matter.
constexpr double kOfLargest = 10;
// Allowance for the uncertainty of the trials, by which the number of points is chosen.
constexpr double kMorePoints = 1.1;

std::size_t trials(std::size_t most_points) {
  return std::clamp(most_points / kOfTrials, kFewPoints, kTrials);
}

BoundedNumber exactly(double value) {
  return {.value = value, .certainty = Certainty::exact, .lower = value, .upper = value};
}

BoundedNumber estimated(double value, double lower, double upper) {
  return {.value = std::clamp(value, lower, upper),
          .certainty = Certainty::estimate,
          .lower = lower,
          .upper = upper};
}

/// A triangle of A.
struct Cell {
  Corners corner{};
  double largest = 0;  ///< bound on the distances of its points

  [[nodiscard]] Vec3 middle() const { return (1.0 / 3) * (corner[0] + corner[1] + corner[2]); }
  /// Distances to a face are convex, and change by no more than the way.
  void bound(const Corners& face) {
    double of_corners = 0, radius = 0;
    for (const Vec3& c : corner) {
      of_corners = std::max(of_corners, hausdorff::upper_face_distance(c, face));
      radius = std::max(radius, norm(c - middle()));
    }
    largest =
        std::min(of_corners, (1 + kFewRoundings) * radius + hausdorff::upper_face_distance(middle(), face));
  }
  [[nodiscard]] std::array<Cell, 2> halves() const {
    int longest = 0;
    double most = -1;
    for (int i = 0; i < 3; ++i)
      if (const double length = squared_norm(corner[(i + 2) % 3] - corner[(i + 1) % 3]); length > most) {
        most = length;
        longest = i;
      }
    const int next = (longest + 1) % 3, last = (longest + 2) % 3;
    std::array<Cell, 2> result{*this, *this};
    result[0].corner[next] = result[1].corner[last] = 0.5 * (corner[next] + corner[last]);
    return result;
  }
};

}  // namespace

DirectedEstimate::DirectedEstimate(const Mesh& a, const sites::SitesData& b, const MetricsOptions& options,
                                   const Scale& scale, std::uint64_t stream)
    : a_(a), b_(b), options_(options), scale_(scale), points_(a), stream_(stream) {}

DirectedMetrics DirectedEstimate::run() {
  const std::size_t few = trials(options_.most_points);
  Sample trial = measure(few, 2 * stream_);
  CompensatedSum squares;
  for (const double d : trial.distances) squares += d * d;
  const double most_usual = kUsual * *std::ranges::max_element(trial.distances);
  const double rms = std::sqrt(squares.value() / static_cast<double>(few));
  largest_ = bound_largest(std::max(most_usual, kOfLargest * rms));
  usual_ = std::min(largest_, most_usual);
  (void)evaluate(std::move(trial));
  const double most = static_cast<double>(std::max(few, options_.most_points));
  const double count = std::clamp(kMorePoints * enough_, static_cast<double>(few), most);
  return evaluate(measure(static_cast<std::size_t>(count), 2 * stream_ + 1));
}

// Faces are halved where their distances may be larger than half of the largest, as long as this may be
// larger than what hardly matters.
double DirectedEstimate::bound_largest(double enough) const {
  constexpr std::size_t kAtOnce = std::size_t{1} << 16, kGrain = 256, kCells = 16;
  double most = 0;  // of cells that are small enough
  std::vector<Cell> open, next;
  const auto bound = [&] {
    std::vector<Vec3> middles;
    middles.reserve(next.size());
    for (const Cell& cell : next) middles.push_back(cell.middle());
    std::vector<ClosestPoint> found(next.size());
    closest::find_scattered(b_, middles, kInfinity, options_.progress, found);
    parallel_for(next.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) next[i].bound(corners_of(b_.mesh, found[i].face));
    });
    for (const Cell& cell : next)
      if (cell.largest > enough)
        open.push_back(cell);
      else
        most = std::max(most, cell.largest);
    next.clear();
  };
  const auto add = [&](const Cell& cell) {
    next.push_back(cell);
    if (next.size() == kAtOnce) bound();
  };
  for (const Triangle& t : a_.triangles)
    if (!hausdorff::repeats_corner(t)) add({corners_of(a_.positions, t)});
  bound();
  std::size_t left = kCells * trials(options_.most_points);
  while (!open.empty()) {
    const double largest = std::ranges::max_element(open, {}, &Cell::largest)->largest;
    const auto divided =
        std::ranges::partition(open, [&](const Cell& cell) { return cell.largest <= largest / 2; });
    if (2 * divided.size() > left) {
      most = std::max(most, largest);
      break;
    }
    left -= 2 * divided.size();
    const std::vector<Cell> whole(divided.begin(), divided.end());
    open.erase(divided.begin(), divided.end());
    for (const Cell& cell : whole)
      for (const Cell& half : cell.halves()) add(half);
    bound();
  }
  return most > 0 ? most + scale_.rounding : 0;
}

DirectedEstimate::Sample DirectedEstimate::measure(std::size_t count, std::uint64_t stream) const {
  Sample sample{.distances = std::vector<double>(count)};
  const SurfacePoints::Runs runs = points_.runs(count, options_.seed, stream);
  std::vector<double> consistency(runs.size());
  parallel_for(runs.size(), 1, options_.progress, "points", [&](std::size_t begin, std::size_t end) {
    std::vector<SurfacePoints::Place> places;
    std::vector<Vec3> at;
    std::vector<std::uint32_t> order;
    std::vector<ClosestPoint> found;
    for (std::size_t r = begin; r < end; ++r) {
      runs.place(r, places);
      at.clear();
      for (const SurfacePoints::Place& place : places) at.push_back(place.at);
      order.resize(at.size());
      found.assign(at.size(), {});
      std::iota(order.begin(), order.end(), 0u);
      closest::closest_of_each(b_, at, order, kInfinity, found);
      for (std::size_t i = 0; i < at.size(); ++i) {
        sample.distances[runs.first(r) + i] = found[i].distance;
        const std::uint32_t nearest = b_.face_of(found[i].type, found[i].site);
        consistency[r] += std::abs(dot(unit_normal(a_, places[i].face), unit_normal(b_.mesh, nearest)));
      }
    }
  });
  for (const double c : consistency) sample.consistency += c / static_cast<double>(count);
  return sample;
}

// Percentiles reorder the distances.
DirectedMetrics DirectedEstimate::evaluate(Sample sample) {
  poll();
  std::vector<double>& distances = sample.distances;
  DirectedMetrics result{.area = points_.area(), .points = distances.size()};
  result.normal_consistency = std::min(1.0, sample.consistency);
  const double found = *std::ranges::max_element(distances) - scale_.rounding;
  const double least = std::clamp(found, 0.0, largest_);
  result.hausdorff = {.value = least, .lower = least, .upper = largest_};
  if (largest_ - least <= scale_.accuracy) result.hausdorff.certainty = Certainty::exact;
  const Mean first = mean(distances, 1), second = mean(distances, 2);
  result.mean = estimated(first.value, first.lower, first.upper);
  result.rms = estimated(std::sqrt(second.value), std::sqrt(second.lower), std::sqrt(second.upper));
  ask_for(first.enough);
  ask_for(second.enough);
  const auto samples = static_cast<double>(distances.size());
  // An interval of so many points that is `half` to a side, where `enough` is asked for.
  const auto ask = [&](const BoundedNumber& number, double enough) {
    const double half = std::max(number.upper - number.value, number.value - number.lower);
    ask_for(samples * (half / enough) * (half / enough));
  };
  for (const double p : options_.percentiles) {
    result.percentiles.push_back(percentile(distances, p));
    ask(result.percentiles.back(), asked(result.percentiles.back().value));
  }
  for (const double t : options_.tolerances) {
    result.within.push_back(within(distances, t));
    ask(result.within.back(), options_.fraction_precision);
  }
  if (largest_ == 0) {
    result.mean = result.rms = exactly(0);
    std::ranges::fill(result.percentiles, exactly(0));
  }
  return result;
}

void DirectedEstimate::ask_for(double points) {
  enough_ = std::max(enough_, points);
}

double DirectedEstimate::asked(double value) const {
  using O = MetricsOptions;
  return std::max(options_.precision.value_or(O::kRelative * value), O::kLeast * scale_.size);
}

// The mean of distances up to the usual one, and at most the largest one for the share of others.
DirectedEstimate::Mean DirectedEstimate::mean(const std::vector<double>& distances, int power) const {
  const auto powered = [power](double d) { return power == 1 ? d : d * d; };
  const double usual = powered(usual_), largest = powered(largest_);
  const std::size_t n = distances.size();
  const auto samples = static_cast<double>(n);
  CompensatedSum all, up_to_usual, squares;
  std::size_t larger = 0;
  for (const double d : distances) {
    all += powered(d);
    up_to_usual += std::min(usual, powered(d));
    larger += d > usual_;
  }
  const double middle = up_to_usual.value() / samples;
  for (const double d : distances) {
    const double off = std::min(usual, powered(d)) - middle;
    squares += off * off;
  }
  const MeanDeviation deviation = mean_deviation(n, squares.value() / (samples - 1), usual, kOfMean);
  const double of_larger = (largest - usual) * most_share(n, larger, kOfShare);
  const double rounding = points_.rounding() * largest + scale_.rounding * (power == 1 ? 1 : 2 * largest_);
  Mean result{.lower = std::max(0.0, middle - deviation.sum() - rounding),
              .upper = std::min(largest, middle + deviation.sum() + of_larger + rounding)};
  result.value = std::clamp(all.value() / samples, result.lower, result.upper);
  const double root = std::sqrt(result.value);
  const double half = power == 1 ? asked(result.value) : 2 * root * asked(root);
  const double of_root = deviation.of_deviation * std::sqrt(samples);
  const double of_all = (deviation.of_range + of_larger) * samples;
  const double root_of_enough = (of_root + std::sqrt(of_root * of_root + 4 * of_all * half)) / (2 * half);
  result.enough = half > 0 ? root_of_enough * root_of_enough : 0;
  return result;
}

BoundedNumber DirectedEstimate::percentile(std::vector<double>& distances, double percent) const {
  const std::size_t n = distances.size();
  const double fraction = percent / 100;
  const std::size_t below = rank_below(n, std::max(0.0, fraction - points_.rounding()), kMiss);
  const std::size_t above = rank_above(n, std::min(1.0, fraction + points_.rounding()), kMiss);
  const auto ranked = [&](std::size_t rank) {
    const auto at = distances.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
    std::ranges::nth_element(distances, at);
    return *at;
  };
  const double lower = below == 0 ? 0 : std::max(0.0, ranked(below) - scale_.rounding);
  const double upper = above > n ? largest_ : std::min(largest_, ranked(above) + scale_.rounding);
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(n)));
  return estimated(ranked(std::clamp<std::size_t>(rank, 1, n)), std::min(lower, upper), upper);
}

BoundedNumber DirectedEstimate::within(const std::vector<double>& distances, double tolerance) const {
  const double limit = tolerance + scale_.accuracy;
  if (largest_ <= limit) return exactly(1);
  const std::size_t n = distances.size();
  const auto within =
      static_cast<std::size_t>(std::ranges::count_if(distances, [&](double d) { return d <= limit; }));
  const double lower = least_share(n, within, kMiss) - points_.rounding();
  const double upper = most_share(n, within, kMiss) + points_.rounding();
  return estimated(static_cast<double>(within) / static_cast<double>(n), std::max(0.0, lower),
                   std::min(1.0, upper));
}

}  // namespace sdm::metrics

// Bounds on means, fractions and percentiles of the whole surface, summed over the parts of a directed
// search.
#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/metrics/directed_search.h"
#include "core/cancellation.h"
#include "core/parallel.h"

namespace sdm::metrics {
namespace {

constexpr std::size_t kSummed = 4096;
// Steps in which the distribution of distances around a percentile is kept in runs.
constexpr std::size_t kSteps = 1024;

/// Calls add(sum, part) for all parts, and merge(sum, other): the same, whatever the number of threads.
template <class Sum, class Add, class Merge>
void sum_parts(std::span<const FacePart> parts, Sum& sum, const Add& add, const Merge& merge) {
  std::vector<Sum> sums((parts.size() + kSummed - 1) / kSummed);
  parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      for (const FacePart& part :
           parts.subspan(n * kSummed).first(std::min(kSummed, parts.size() - n * kSummed)))
        add(sums[n], part);
  });
  for (const Sum& other : sums) merge(sum, other);
}

BoundedNumber between(double lower, double upper) {
  upper = std::max(lower, upper);
  return {.value = lower + (upper - lower) / 2, .lower = lower, .upper = upper};
}

}  // namespace

double DirectedSearch::consistency() const {
  double sum = 0;
  sum_parts(
      parts_, sum,
      [this](double& s, const FacePart& part) {
        s += part.area * std::abs(dot(unit_normal(a_, part.face), unit_normal(b_.mesh, part.nearest)));
      },
      [](double& s, double other) { s += other; });
  return sum;
}

DirectedSearch::Steps::Steps(const BoundedNumber& found)
    : bounds(found), below_low(kSteps + 1), below_high(kSteps + 1) {}

double DirectedSearch::Steps::at(std::size_t i) const {
  return i == kSteps ? bounds.upper
                     : bounds.lower + (bounds.upper - bounds.lower) * static_cast<double>(i) / kSteps;
}

void DirectedSearch::Steps::add(const FacePart& part) {
  const auto add_to = [&](std::vector<CompensatedSum>& below, const TwoSided& bound) {
    const double width = bounds.upper - bounds.lower;
    const double step = (bound.least() - bounds.lower) / width * kSteps;
    // The first step that may have a part of it; where all of it is below, the next ones have it too.
    auto i = static_cast<std::size_t>(std::clamp(step - 1, 0.0, static_cast<double>(kSteps)));
    double counted = 0;
    for (; i <= kSteps && counted < 1; ++i) {
      const double fraction = bound.fraction_within(at(i));
      below[i] += part.area * (fraction - counted);
      counted = fraction;
    }
  };
  add_to(below_low, part.lower());
  add_to(below_high, part.upper());
}

// Sums are in the order of the parts, whatever the number of threads.
void DirectedSearch::add_means(const std::vector<FacePart>& parts, Means& means) {
  sum_parts(
      parts, means,
      [](Means& m, const FacePart& part) {
        const TwoSided low = part.lower(), high = part.upper();
        m.largest = std::max(m.largest, high.largest());
        m.low += part.area * low.mean();
        m.high += part.area * high.mean();
        m.square_low += part.area * low.mean_square();
        m.square_high += part.area * high.mean_square();
      },
      [](Means& m, const Means& other) {
        m.largest = std::max(m.largest, other.largest);
        m.low += other.low.value();
        m.high += other.high.value();
        m.square_low += other.square_low.value();
        m.square_high += other.square_high.value();
      });
}

// Areas that are off by a fraction of the whole change a mean by at most that fraction of the largest
// distance.
void DirectedSearch::sum_up() {
  poll();
  Means means = settled_.means;
  add_means(parts_, means);
  const auto rounded = [&](double low, double high) {
    return between(std::max(0.0, low - scale_.rounding), high > 0 ? high + scale_.rounding : 0);
  };
  largest_ = means.largest;
  const double off = rounding_ * means.largest;
  sums_.mean = rounded(means.low.value() / sums_.area - off, means.high.value() / sums_.area + off);
  sums_.rms = rounded(std::sqrt(std::max(0.0, means.square_low.value() / sums_.area - off * means.largest)),
                      std::sqrt(means.square_high.value() / sums_.area + off * means.largest));
  known_percentiles_ = std::exchange(sums_.percentiles, {});
  sums_.within.clear();
  for (std::size_t i = 0; i < options_.percentiles.size(); ++i) sums_.percentiles.push_back(percentile(i));
  for (std::size_t i = 0; i < options_.tolerances.size(); ++i) sums_.within.push_back(within(i));
}

// Distances that are equal to a tolerance, as those of voxels are, shall not depend on rounding.
double DirectedSearch::limit(double tolerance) const {
  return tolerance + scale_.accuracy;
}

void DirectedSearch::add_within(const std::vector<FacePart>& parts, double limit, Within& sum) {
  sum_parts(
      parts, sum,
      [limit](Within& w, const FacePart& part) {
        const double surely = part.upper().fraction_within(limit),
                     maybe = part.lower().fraction_within(limit);
        w.low += part.area * surely;
        w.high += part.area * maybe;
        w.all = w.all && surely == 1;
        w.any = w.any || maybe > 0;
      },
      [](Within& w, const Within& other) {
        w.low += other.low.value();
        w.high += other.high.value();
        w.all = w.all && other.all;
        w.any = w.any || other.any;
      });
}

BoundedNumber DirectedSearch::within(std::size_t tolerance) const {
  poll();
  Within sum = settled_.within.empty() ? Within{} : settled_.within[tolerance];
  add_within(parts_, limit(options_.tolerances[tolerance]), sum);
  return between(sum.all ? 1 : std::max(0.0, sum.low.value() / sums_.area - rounding_),
                 !sum.any ? 0 : std::min(1.0, sum.high.value() / sums_.area + rounding_));
}

BoundedNumber DirectedSearch::percentile(std::size_t number) const {
  const double fraction = options_.percentiles[number] / 100;
  const double least = std::max(0.0, fraction - rounding_), most = std::min(1.0, fraction + rounding_);
  if (!settled_.percentiles.empty()) return percentile(settled_.percentiles[number], least, most);
  const BoundedNumber known =
      number < known_percentiles_.size() ? known_percentiles_[number] : between(0, largest_);
  const double low = quantile(least, &FacePart::lower, known), high = quantile(most, &FacePart::upper, known);
  return between(std::max(0.0, low - scale_.rounding), high > 0 ? high + scale_.rounding : 0);
}

// The percentile of parts that are all settled, within the bounds that were known before.
BoundedNumber DirectedSearch::percentile(const Steps& steps, double least, double most) const {
  double lower = steps.bounds.lower, upper = steps.bounds.upper;
  CompensatedSum low, high;
  bool below = true, found = false;
  for (std::size_t i = 0; i <= kSteps; ++i) {
    low += steps.below_low[i].value();
    high += steps.below_high[i].value();
    below = below && low.value() < least * sums_.area;
    if (below) lower = std::max(lower, steps.at(i) - scale_.rounding);
    if (!found && high.value() >= most * sums_.area) {
      found = true;
      upper = std::min(upper, steps.at(i) + scale_.rounding);
    }
  }
  return between(lower, upper);
}

double DirectedSearch::quantile(double fraction, TwoSided (FacePart::*bound)() const,
                                const BoundedNumber& known) const {
  struct Piece {
    TwoSided bound;
    double area;
  };
  struct Open {
    std::vector<Piece> pieces;
    CompensatedSum below;
  };
  // Pieces that are wholly below `lo` count from now on, those above `hi` do not.
  double lo = known.lower, hi = known.upper;
  Open open;
  sum_parts(
      parts_, open,
      [&](Open& some, const FacePart& part) {
        const TwoSided distance = (part.*bound)();
        if (distance.largest() <= lo)
          some.below += part.area;
        else if (distance.least() <= hi)
          some.pieces.push_back({distance, part.area});
      },
      [](Open& all, const Open& some) {
        all.below += some.below.value();
        all.pieces.insert(all.pieces.end(), some.pieces.begin(), some.pieces.end());
      });
  const double asked = fraction * sums_.area;
  constexpr int kHalvings = 60;
  for (int n = 0; n < kHalvings && lo < hi; ++n) {
    poll();
    const double middle = lo + (hi - lo) / 2;
    CompensatedSum area = open.below;
    for (const Piece& piece : open.pieces) area += piece.area * piece.bound.fraction_within(middle);
    (area.value() >= asked ? hi : lo) = middle;
    std::erase_if(open.pieces, [&](const Piece& piece) {
      if (piece.bound.largest() <= lo) open.below += piece.area;
      return piece.bound.largest() <= lo || piece.bound.least() > hi;
    });
  }
  return bound == &FacePart::lower ? lo : hi;
}

}  // namespace sdm::metrics

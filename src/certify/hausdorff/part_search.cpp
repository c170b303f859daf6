#include "certify/hausdorff/part_search.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "certify/hausdorff/first_parts.h"
#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::hausdorff {
namespace {

// Parts are evaluated at least this many at a time, the highest bounds first; of many open parts, a fraction.
constexpr std::size_t kBatch = 256, kFraction = 4;
constexpr std::size_t kGrain = 16;  // parts evaluated in a row: each may profit from those before
// Of more open parts than this, the last ones are evaluated: depth first, so that there are hardly more.
constexpr std::size_t kMany = 1 << 20, kBatchOfMany = 1 << 12;
// A part is divided at most this often: its longest side is then halved some 50 times.
constexpr int kMostDivisions = 200;
// A bound that comes closer to the lower bound by this factor is worth another evaluation before a division.
constexpr double kProgress = 0.5;
// Of the precision: distances that differ less count as equal.
constexpr double kEqual = 1.0 / 16;

}  // namespace

void PartSearch::start(const Mesh& a, std::span<const VertexDistance> vertices) {
  FirstParts first = first_parts(a, b_, vertices, lower_.value, precision_);
  open_ = std::move(first.parts);
  settled_ = first.settled;
}

double PartSearch::finish(const Progress& progress) {
  std::vector<Outcome> outcomes;
  double first_gap = 0;
  while (!open_.empty()) {
    const std::size_t before = open_.size() - choose_batch();
    const std::span<const Part> batch = std::span(open_).subspan(before);
    const std::size_t runs = (batch.size() + kGrain - 1) / kGrain;
    outcomes.assign(runs, {});
    parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        evaluate(batch.subspan(kGrain * i, std::min(kGrain, batch.size() - kGrain * i)), outcomes[i]);
    });
    open_.resize(before);
    for (const Outcome& outcome : outcomes) {
      lower_.raise(outcome.lower);
      settled_ = std::max(settled_, outcome.settled);
      open_.insert(open_.end(), outcome.open.begin(), outcome.open.end());
    }
    if (progress && !open_.empty()) {
      const double gap = std::max(std::ranges::max(open_, {}, &Part::upper).upper - lower_.value, precision_);
      if (first_gap == 0) first_gap = gap;
      const double done =
          first_gap > precision_ ? std::log(first_gap / gap) / std::log(first_gap / precision_) : 1;
      if (!progress("parts", std::clamp(done, 0.0, 1.0))) throw Cancelled();
    }
  }
  return std::max(lower_.value, settled_);
}

// Moves the parts to evaluate next to the end of the open ones, and returns their number.
std::size_t PartSearch::choose_batch() {
  if (open_.size() > kMany) return kBatchOfMany;
  const std::size_t count = std::min(open_.size(), std::max(kBatch, open_.size() / kFraction));
  std::ranges::nth_element(open_, open_.end() - static_cast<std::ptrdiff_t>(count), {}, &Part::upper);
  return count;
}

void PartSearch::evaluate(std::span<const Part> parts, Outcome& outcome) const {
  outcome.lower = lower_;
  for (const Part& part : parts) evaluate(part, outcome);
}

void PartSearch::evaluate(const Part& part, Outcome& outcome) const {
  const double gap = part.upper - outcome.lower.value;
  if (gap <= precision_) {
    outcome.settled = std::max(outcome.settled, part.upper);
    return;
  }
  // Some face that is near the point.
  const Vec3 highest = part.highest_point();
  std::uint32_t start = part.near[0];
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < part.count; ++k) {
    const Vec3& d = part.distances[k];
    const double about = part.weights[0] * d[0] + part.weights[1] * d[1] + part.weights[2] * d[2];
    if (about < least) least = about, start = part.near[k];
  }
  const NearestFace nearest = nearest_face(b_, highest, start);
  outcome.lower.raise(highest, part.depth == 0 && part.support() == 1 ? 0 : rounding(part), part.face,
                      nearest);
  Part better = part;
  double reach = 0;  // of the part, from the point
  for (const Vec3& corner : part.at) reach = std::max(reach, norm(corner - highest));
  constexpr double kRounding = 1e-15;
  better.upper = std::min(part.upper, (1 + kRounding) * (nearest.upper + reach));  // as d is 1-Lipschitz
  // Where B has needles, the bounds on a distance may be farther apart than the precision: no division helps.
  constexpr double kFinest = 1.0 / 8;  // of the precision
  const bool finest = reach <= std::max(kFinest * precision_, nearest.upper - nearest.lower);
  if (finest || part.depth == kMostDivisions) {
    outcome.settled = std::max(outcome.settled, better.upper + rounding(part));
    return;
  }
  const double tolerance = kEqual * precision_;
  if (const double before = better.upper; better.add(b_, nearest.face, tolerance)) {
    better.bound();
    better.upper = std::min(better.upper, before);
    if (better.upper - outcome.lower.value <= kProgress * gap) return put(better, outcome);
  }
  Pieces pieces = divide(better, b_, tolerance);
  for (int i = 0; i < pieces.count; ++i) {
    Part& piece = pieces.part[i];
    piece.upper = std::min(piece.upper, better.upper);
    piece.stalled = !part.stalled && piece.upper - outcome.lower.value > kProgress * gap;
    put(piece, outcome);
  }
}

// Bounds of divided parts include the rounding of their corners.
void PartSearch::put(Part part, Outcome& outcome) const {
  if (part.depth > 0) part.upper += rounding(part);
  if (part.upper <= outcome.lower.value + precision_)
    outcome.settled = std::max(outcome.settled, part.upper);
  else
    outcome.open.push_back(part);
}

// Points of a part are computed from its corners, each with an error of less than 1e-15 of the coordinates,
// which adds up over divisions.
double PartSearch::rounding(const Part& part) const {
  return 1e-15 * (2 + part.depth) * coordinate_;
}

}  // namespace sdm::hausdorff

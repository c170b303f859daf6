#include "simplify/certificate.h"

#include <algorithm>

#include "certify/hausdorff/largest_distance.h"
#include "geometry/vec.h"
#include "simplify/high_parts.h"
#include "sites/sites_data.h"

namespace sdm::simplify {
namespace {

// Bounds are this close, relative to the limit or the distance.
constexpr double kClose = 0.01;
// Where these contain the limit, they are made this many times closer, so often: whether a distance keeps a
// limit must not depend on the limit otherwise.
constexpr double kCloser = 16;
constexpr int kMostTries = 3;
// Bounds are no closer than this share of the diagonal, unless a limit asks for it.
constexpr double kLast = 1e-6;
// So many parts of the result are examined at most: flat surfaces, at the distance 0 everywhere, would take
// forever.
constexpr std::size_t kMostParts = std::size_t{1} << 23;
// Below this fraction of the limit, distances need not be told apart.
constexpr double kFarBelow = 0.7;

// Adds what was found in a direction. `rounding`: of distances.
void raise(BoundedLength& result, const hausdorff::LargestDistance& found, double rounding, bool from_input) {
  result.upper = std::max(result.upper, found.upper);
  const hausdorff::LowerBound& at = found.lower;
  if (at.faces[0] == kNone) return;
  // The value is larger where distances are forgiven up to the limit.
  const double distance = std::clamp(norm(at.closest - at.point) - rounding, 0.0, std::max(0.0, at.value));
  if (distance < result.lower || (result.witness && distance == result.lower)) return;
  result.lower = distance;
  result.witness = from_input ? std::array{at.point, at.closest} : std::array{at.closest, at.point};
}

}  // namespace

BoundedLength deviation_of_input(const Sites& input, const Mesh& result, const Expected& expected,
                                 const Progress& progress) {
  const Sites sites(result);
  const double size = diagonal(bounds(input.mesh()));
  const hausdorff::Scale scale = hausdorff::scale_of(input.mesh(), bounds(result));
  BoundedLength d;
  const auto measure = [&](double precision) {
    d.upper = 0;  // of the directions only this one has bounds yet
    const auto found = hausdorff::largest_distance(input.mesh(), internals(sites), scale,
                                                   {.precision = precision}, progress);
    raise(d, found, scale.precision, true);
  };
  if (expected.limit < kInfinity) {
    double precision = kClose * expected.limit;
    measure(precision);
    for (int tries = 1; tries < kMostTries && d.lower <= expected.limit && d.upper > expected.limit; ++tries)
      measure(precision /= kCloser);
  } else {
    const double first = std::max(kLast * size, kClose * expected.estimate);
    measure(first);
    if (const double closer = std::max(kLast * size, kClose * d.lower); 2 * closer < first) measure(closer);
  }
  d.value = d.lower;
  return d;
}

BoundedLength with_deviation_of_result(const BoundedLength& of_input, const Sites& input, const Mesh& result,
                                       const Expected& expected, const Progress& progress) {
  BoundedLength d = of_input;
  const Box box = bounds(input.mesh());
  const hausdorff::Scale scale = hausdorff::scale_of(result, box);
  const bool limited = expected.limit < kInfinity;
  hausdorff::Question question{
      .precision = limited ? kClose * expected.limit : std::max(kLast * diagonal(box), kClose * d.lower),
      .most_parts = kMostParts};
  for (int tries = 1;; ++tries) {
    d.upper = of_input.upper;
    // What is below this changes nothing.
    double settled = std::max(d.lower, question.precision);
    if (limited) {
      const double forgiven = std::max(0.0, expected.limit - question.precision - scale.precision);
      settled = std::clamp(d.lower, kFarBelow * forgiven, forgiven);
      question.decision = hausdorff::Decision{settled, forgiven};
    }
    const Mesh rest = parts_above(result, internals(input), settled, progress);
    d.upper = std::max(d.upper, settled + scale.precision);
    if (!rest.triangles.empty()) {
      auto found = hausdorff::largest_distance(rest, internals(input), scale, question, progress);
      found.upper += scale.precision;  // of the corners of parts
      raise(d, found, scale.precision, false);
    }
    const bool decided = d.lower > expected.limit || d.upper <= expected.limit;
    if (!limited || decided || of_input.upper > expected.limit || tries == kMostTries) break;
    question.precision /= kCloser;
  }
  d.value = d.lower;
  return d;
}

}  // namespace sdm::simplify

#include "certify/hausdorff/part_search.h"

#include <algorithm>

#include "geometry/rounding.h"

namespace sdm::hausdorff {
namespace {

// A part is divided at most this often: its longest side is then halved some 50 times.
constexpr int kMostDivisions = 200;
// A bound that comes closer to the lower bound by this factor is worth another evaluation before a division.
constexpr double kProgress = 0.5;
// Distances that differ by less than this fraction of the precision count as equal.
constexpr double kEqual = 1.0 / 16;

}  // namespace

double PartSearch::operator()(const Mesh& a, std::span<const VertexDistance> vertices,
                              const Progress& progress) {
  forgive();
  return (*this)(first_parts(a, b_, vertices, lower_.value, precision_), progress);
}

double PartSearch::operator()(const FirstParts& first, const Progress& progress) {
  forgive();
  parts_.start(lower_.value, precision_);
  parts_.settle(first.settled);
  for (const FacePart& part : first.parts) parts_.put(part);
  search::branch_and_bound(*this, parts_, progress);
  return parts_.upper();
}

void PartSearch::evaluate(std::span<const FacePart> run, Found& found) const {
  found.lower = lower_;
  found.settled = 0;
  found.open.clear();
  for (const FacePart& part : run) evaluate(part, found);
}

void PartSearch::learn(std::span<const FacePart> run, const Found& found) {
  examined_ += run.size();
  lower_.raise(found.lower);
  forgive();
  parts_.raise(lower_.value);
}

void PartSearch::conclude(std::span<const FacePart> /*run*/, const Found& found) {
  parts_.settle(found.settled);
  for (const FacePart& part : found.open) parts_.put(part);
}

// Once a distance above the limit is known, only larger ones than those that are forgiven matter.
void PartSearch::forgive() {
  if (decision_ && lower_.value > decision_->limit)
    lower_.value = std::max(lower_.value, decision_->forgiven);
}

void PartSearch::evaluate(const FacePart& part, Found& found) const {
  const double gap = part.upper - found.lower.value;
  if (gap <= precision_) {
    found.settled = std::max(found.settled, part.upper);
    return;
  }
  // Some face that is near the point.
  const Vec3 highest = part.highest_point();
  std::uint32_t start = part.b_faces[0];
  double least = kInfinity;
  for (int k = 0; k < part.count; ++k) {
    const Vec3& d = part.distances[k];
    const double about = part.weights[0] * d[0] + part.weights[1] * d[1] + part.weights[2] * d[2];
    if (about < least) {
      least = about;
      start = part.b_faces[k];
    }
  }
  const NearestFace nearest = matching_ == nullptr ? nearest_face(b_, highest, start)
                                                   : nearest_face(b_, highest, start, *matching_, part.face);
  found.lower.raise(highest, part.depth == 0 && part.support() == 1 ? 0 : rounding(part), part.face, nearest);
  FacePart better = part;
  double radius = 0;  // of the part, about the point
  for (const Vec3& corner : part.at) radius = std::max(radius, norm(corner - highest));
  better.upper = std::min(part.upper, (1 + kFewRoundings) * (nearest.upper + radius));  // as d is 1-Lipschitz
  if (const Side* side = found.lower.side;
      side != nullptr && nearest.lower > 0 && !side->has(highest, nearest.upper)) {
    better.upper = side->bound(part.at, {better.upper, nearest.lower, radius, precision_});
    better.stalled = true;
    if (better.upper + rounding(part) <= found.lower.value + precision_) {
      found.settled = std::max(found.settled, better.upper + rounding(part));
      return;
    }
  }
  // Where B has needles, the bounds on a distance may be farther apart than the precision: no division helps.
  constexpr double kFinest = 1.0 / 8;  // of the precision
  const bool finest = radius <= std::max(kFinest * precision_, nearest.upper - nearest.lower);
  if (finest || part.depth == kMostDivisions) {
    found.settled = std::max(found.settled, better.upper + rounding(part));
    return;
  }
  const double tolerance = kEqual * precision_;
  if (const double before = better.upper; better.add(b_, nearest.face, tolerance)) {
    better.bound();
    better.upper = std::min(better.upper, before);
    if (better.upper - found.lower.value <= kProgress * gap) return put(better, found);
  }
  Pieces pieces = cut_along(better, b_, nearest.face, found.lower.value + precision_);
  if (pieces.count == 0) pieces = divide(better, b_, tolerance);
  for (int i = 0; i < pieces.count; ++i) {
    FacePart& piece = pieces.part[i];
    piece.upper = std::min(piece.upper, better.upper);
    piece.stalled = !part.stalled && piece.upper - found.lower.value > kProgress * gap;
    put(piece, found);
  }
}

// Bounds of divided parts include the rounding of their corners.
void PartSearch::put(FacePart part, Found& found) const {
  if (part.depth > 0) part.upper += rounding(part);
  if (part.upper <= found.lower.value + precision_)
    found.settled = std::max(found.settled, part.upper);
  else
    found.open.push_back(part);
}

// Points of a part are computed from its corners, each with an error of less than 1e-15 of the coordinates,
// which adds up over divisions.
double PartSearch::rounding(const FacePart& part) const {
  return 1e-15 * (2 + part.depth) * coordinate_;
}

}  // namespace sdm::hausdorff

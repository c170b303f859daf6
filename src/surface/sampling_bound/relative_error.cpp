#include <sdm/error.h>
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <limits>
#include <new>
#include <string>

#include "core/memory.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm {
namespace {

double ratio(double now, double first) {
  return first > 0 ? now / first : std::numeric_limits<double>::infinity();
}

void check_faces(std::size_t count, std::size_t expected) {
  if (count != expected)
    throw Error("a relative error of " + std::to_string(count) + " faces was asked for of a surface of " +
                std::to_string(expected) + "; compare a surface with its own initial geometry");
}

std::vector<double> lower_bounds(const Surface& first_shape, const SamplingBound& bound) {
  internals(bound).require_same(first_shape);
  return internals(bound).radius_lower_bounds(first_shape, bound.value());
}

}  // namespace

RelativeError::RelativeError(const Surface& first_shape, const SamplingBound& bound) try
    : first_(lower_bounds(first_shape, bound)), largest_(*std::ranges::max_element(first_)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sampling bound of the atlas");
}

double RelativeError::of(const SamplingBound& now) const {
  check_faces(now.face_radii().size(), first_.size());
  return ratio(now.value(), largest_);
}

double RelativeError::of_edited(const SamplingBound& now) const {
  return ratio(now.value(), largest_);
}

void RelativeError::of_faces(const SamplingBound& now, std::span<double> errors) const {
  check_faces(now.face_radii().size(), first_.size());
  check_faces(errors.size(), first_.size());
  std::ranges::transform(now.face_radii(), first_, errors.begin(), ratio);
}

}  // namespace sdm

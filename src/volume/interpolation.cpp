#include "volume/interpolation.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "volume/grid.h"

namespace sdm {
namespace volume {
namespace {

// A corner of a cell at the distance `apart` from the point, where the distance is `value`.
void include(FieldSample& sample, double value, double apart, const DistanceField& field) {
  if (std::isnan(value)) {  // beyond the maximum distance, on either side
    sample.magnitude = std::max(sample.magnitude, field.max_distance - apart);
    return;
  }
  switch (field.sign.method) {
    case SignMethod::exact:
      sample.lower = std::max(sample.lower, value - apart);
      break;
    case SignMethod::winding:
    case SignMethod::side:  // an estimate of the sign, which changes anywhere
      value = std::abs(value);
      sample.magnitude = std::max(sample.magnitude, value - apart);
      break;
    default:
      sample.magnitude = std::max(sample.magnitude, value - apart);
  }
  sample.upper = std::min(sample.upper, value + apart);
}

// Completes the bounds of a sample whose corners have been included.
void complete(FieldSample& sample, SignMethod sign) {
  switch (sign) {
    case SignMethod::exact:
      sample.magnitude = std::max({sample.magnitude, sample.lower, -sample.upper});
      break;
    case SignMethod::winding:
    case SignMethod::side:
      sample.lower = -sample.upper;
      break;
    default:
      sample.lower = sample.magnitude;
  }
}

}  // namespace

Interpolation::Interpolation(const DistanceField& field) : field_(field) {
  check_grid(field.grid);
  if (field.distance.size() != field.grid.size())
    throw Error("the field has " + std::to_string(field.distance.size()) + " distances for a grid of " +
                std::to_string(field.grid.size()) + " points");
}

FieldSample Interpolation::operator()(const Vec3& p) const {
  const Grid& grid = field_.grid;
  std::array<std::uint32_t, 3> cell{};
  Vec3 place{};  // in the cell
  bool outside = false;
  for (int k = 0; k < 3; ++k) {
    const double last = grid.dims[k] - 1, at = (p[k] - grid.origin[k]) / grid.spacing[k];
    outside |= !(0 <= at && at <= last);
    const double clamped = std::clamp(at, 0.0, last);
    cell[k] = static_cast<std::uint32_t>(std::min(clamped, std::max(last - 1, 0.0)));
    place[k] = clamped - cell[k];
  }
  FieldSample sample;
  double value = 0;
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<std::uint32_t, 3> at = cell;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t up = corner >> k & 1;
      weight *= up != 0 ? place[k] : 1 - place[k];
      at[k] += up;
    }
    if (weight == 0) continue;
    const double d = field_.distance[grid.index(at[0], at[1], at[2])];
    value += weight * d;
    include(sample, d, norm(grid.point(at[0], at[1], at[2]) - p) + field_.accuracy, field_);
  }
  if (!outside) sample.value = value;
  const double apart = norm(gap(field_.o2_bounds, {p, p}));
  sample.magnitude = std::max(sample.magnitude, apart);
  if (apart > 0 && field_.sign.method == SignMethod::exact) sample.lower = std::max(sample.lower, apart);
  complete(sample, field_.sign.method);
  return sample;
}

}  // namespace volume

std::vector<FieldSample> sample_field(const DistanceField& field, std::span<const Vec3> points) try {
  const volume::Interpolation at(field);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!finite(points[i]))
      throw Error("point " + std::to_string(i) + " has a coordinate that is NaN or infinite");
  std::vector<FieldSample> samples(points.size());
  parallel_for(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) samples[i] = at(points[i]);
  });
  return samples;
} catch (const std::bad_alloc&) {
  throw out_of_memory("samples of a distance field");
}

double interpolation_error(const Grid& grid) {
  double squared = 0;
  for (int k = 0; k < 3; ++k)
    if (grid.dims[k] > 1) squared += grid.spacing[k] * grid.spacing[k];
  return 0.5 * std::sqrt(squared);
}

}  // namespace sdm

// Proximity from a distance field: the distances at samples of O1's surface, interpolated.
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/triangle.h"
#include "research/fields/fields.h"
#include "volume/interpolation.h"

namespace sdm::fields {
namespace {

// What the samples of some faces have in common.
struct Extremes {
  std::size_t samples = 0, without_value = 0;
  double nearest = kInfinity, nearest_lower = kInfinity, nearest_upper = kInfinity;  // |distance|
  double lowest = kInfinity, lowest_lower = kInfinity, lowest_upper = kInfinity;     // distance

  // A sample within `radius` of the points of the surface that it stands for.
  void include(const FieldSample& s, double radius) {
    ++samples;
    if (std::isnan(s.value)) {
      ++without_value;
    } else {
      nearest = std::min(nearest, std::abs(s.value));
      lowest = std::min(lowest, s.value);
    }
    nearest_lower = std::min(nearest_lower, s.magnitude - radius);
    nearest_upper = std::min(nearest_upper, std::max(s.upper, -s.lower));
    lowest_lower = std::min(lowest_lower, s.lower - radius);
    lowest_upper = std::min(lowest_upper, s.upper);
  }
  void include(const Extremes& other) {
    samples += other.samples;
    without_value += other.without_value;
    nearest = std::min(nearest, other.nearest);
    nearest_lower = std::min(nearest_lower, other.nearest_lower);
    nearest_upper = std::min(nearest_upper, other.nearest_upper);
    lowest = std::min(lowest, other.lowest);
    lowest_lower = std::min(lowest_lower, other.lowest_lower);
    lowest_upper = std::min(lowest_upper, other.lowest_upper);
  }
};

// A face, divided into congruent triangles.
struct FaceSamples {
  Corners corners;
  double parts;   // of each side
  double radius;  // no point of the face is farther from all samples

  // Discs around the corners of a triangle with the radius L / √3, for its longest side L, cover it: that is
  // at least the radius of the smallest disc that contains it (Jung 1901).
  FaceSamples(const Mesh& mesh, const Triangle& t, double spacing) : corners(corners_of(mesh.positions, t)) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, norm(corners[(k + 1) % 3] - corners[k]));
    parts = std::max(1.0, std::ceil(longest / spacing));
    radius = longest / (parts * std::sqrt(3.0));
  }
  [[nodiscard]] double count() const { return 0.5 * (parts + 1) * (parts + 2); }

  template <class Visit>
  void for_each(Visit&& visit) const {
    for (double i = 0; i <= parts; ++i)
      for (double j = 0; i + j <= parts; ++j)
        visit(corners[0] + (i / parts) * (corners[1] - corners[0]) + (j / parts) * (corners[2] - corners[0]));
  }
};

double spacing_of(const ProximityOptions& options, const Grid& grid) {
  if (!(options.sample_spacing >= 0)) throw Error("the spacing of samples must not be negative");
  if (options.sample_spacing > 0) return options.sample_spacing;
  double least = kInfinity;
  for (int k = 0; k < 3; ++k)
    if (grid.dims[k] > 1) least = std::min(least, grid.spacing[k]);
  return std::isfinite(least) ? least : grid.spacing[0];
}

BoundedLength length(double value, double lower, double upper) {
  BoundedLength result;
  result.value = value;
  result.lower = std::max(lower, 0.0);
  result.upper = std::max(upper, 0.0);
  result.certainty = std::isfinite(result.upper) ? Certainty::bounded : Certainty::estimate;
  return result;
}

}  // namespace

Proximity proximity(const DistanceField& field, const Mesh& o1, const ProximityOptions& options) try {
  validate(o1);
  const volume::Interpolation at(field);
  const double spacing = spacing_of(options, field.grid);
  constexpr double kMostSamples = 1e10;
  double count = 0;
  Proximity result;
  for (const Triangle& t : o1.triangles) {
    const FaceSamples face(o1, t, spacing);
    count += face.count();
    result.covering_radius = std::max(result.covering_radius, face.radius);
  }
  if (!(count <= kMostSamples))
    throw Error("O1 would have more than 10^10 samples; choose a larger spacing of samples");

  Extremes all;
  std::mutex mutex;
  parallel_for(o1.triangles.size(), 64, options.progress, "samples", [&](std::size_t begin, std::size_t end) {
    Extremes here;
    for (std::size_t f = begin; f < end; ++f) {
      const FaceSamples face(o1, o1.triangles[f], spacing);
      face.for_each([&](const Vec3& p) { here.include(at(p), face.radius); });
    }
    const std::lock_guard lock(mutex);
    all.include(here);
  });

  const SignMethod sign = field.sign.method;
  result.samples = all.samples;
  result.without_value = all.without_value;
  result.error_bound = interpolation_error(field.grid) + field.accuracy + result.covering_radius;
  result.separation = length(std::isfinite(all.nearest) ? all.nearest : all.nearest_upper, all.nearest_lower,
                             all.nearest_upper);
  if (sign != SignMethod::none) {
    result.depth = length(std::max(-all.lowest, 0.0), -all.lowest_upper, -all.lowest_lower);
    if (sign == SignMethod::winding) result.depth->certainty = Certainty::estimate;
  }
  const bool apart = (sign == SignMethod::exact ? all.lowest_lower : all.nearest_lower) > 0;
  const bool inside = sign == SignMethod::exact && all.lowest_upper < 0;
  const bool certain = inside || (apart && sign != SignMethod::winding);
  result.colliding = certain ? inside : all.lowest <= (sign == SignMethod::none ? result.error_bound : 0);
  result.colliding_certainty = certain ? Certainty::exact : Certainty::estimate;
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("proximity from a distance field");
}

}  // namespace sdm::fields

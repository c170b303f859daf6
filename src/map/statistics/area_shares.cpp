#include <sdm/error.h>
#include <sdm/statistics.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "map/statistics/texel_areas.h"
#include "map/statistics/tolerance_limits.h"
#include "map/statistics/weighted_texels.h"

namespace sdm {
namespace {

using map::WeightedTexels;

// The area of the texels of each of some classes.
struct ClassAreas : std::vector<double> {
  using std::vector<double>::vector;
  void operator+=(const ClassAreas& other) { std::ranges::transform(*this, other, begin(), std::plus()); }
};

// Returns the share of the area that each class has; class_of(distance) is the number of one, also where the
// distance is not finite. All are 0 without texels.
template <class ClassOf>
std::vector<double> shares(const Surface& surface, const DistanceMap& map, std::size_t classes,
                           const ClassOf& class_of) {
  const WeightedTexels texels(surface, map);
  ClassAreas areas = WeightedTexels::sum<ClassAreas>([&](std::size_t part) {
    ClassAreas of_part(classes, 0.0);
    texels.for_each(part, [&](float d, float weight, std::uint32_t) { of_part[class_of(d)] += weight; });
    return of_part;
  });
  double all = 0;
  for (const double area : areas) all += area;
  if (all > 0)
    for (double& area : areas) area /= all;
  return areas;
}

void check_increasing(std::span<const double> edges) {
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (!std::isfinite(edges[i]) || (i > 0 && !(edges[i - 1] < edges[i])))
      throw Error("the edges of bands must be finite and increasing");
}

}  // namespace

double area_fraction_beyond(const Surface& surface, const DistanceMap& map, double limit) {
  return shares(surface, map, 2, [limit](float d) { return std::abs(d) <= limit ? 0u : 1u; })[1];
}

double area_fraction_without_texels(const Surface& surface) {
  const double all = map::surface_area(surface.mesh());
  double without = 0;
  for (const std::uint32_t face : surface.map_faces().subspan(surface.texel_faces().size()))
    without += map::face_area(surface.mesh(), face);
  return all > 0 ? without / all : 0;
}

ToleranceShares tolerance_shares(const Surface& surface, const DistanceMap& map, const Tolerance& tolerance,
                                 double accuracy) {
  const map::ToleranceLimits limits(tolerance, accuracy);
  const auto of = shares(surface, map, 4, [&](float d) -> std::size_t {
    if (!std::isfinite(d)) return 3;
    return limits.below(d) ? 0 : limits.above(d) ? 2 : 1;
  });
  return {.below = of[0], .within = of[1], .above = of[2], .without_value = of[3]};
}

std::vector<DistanceBand> distance_bands(const Surface& surface, const DistanceMap& map,
                                         std::span<const double> edges, const DistanceBandOptions& options) {
  check_increasing(edges);
  // The largest number of the band below each edge.
  std::vector<double> last;
  for (const double edge : edges)
    last.push_back(edge > options.centre ? edge + options.accuracy
                                         : std::nextafter(edge - options.accuracy, -kInfinity));
  const auto of = shares(surface, map, edges.size() + 2, [&](float d) -> std::size_t {
    if (!std::isfinite(d)) return edges.size() + 1;
    return static_cast<std::size_t>(std::ranges::lower_bound(last, double{d}) - last.begin());
  });
  std::vector<DistanceBand> bands;
  for (std::size_t i = 0; i <= edges.size(); ++i)
    bands.push_back({.lower = i > 0 ? edges[i - 1] : -kInfinity,
                     .upper = i < edges.size() ? edges[i] : kInfinity,
                     .area_fraction = of[i]});
  return bands;
}

DistanceHistogram distance_histogram(const Surface& surface, const DistanceMap& map,
                                     const std::array<double, 2>& range, std::size_t bins) {
  const double lower = range[0], upper = range[1];
  if (!(std::isfinite(lower) && std::isfinite(upper) && lower < upper) || bins == 0)
    throw Error("a histogram needs a bin and a range of two finite numbers, the smaller one first");
  const double per_unit = static_cast<double>(bins) / (upper - lower);
  const auto of = shares(surface, map, bins + 3, [&](float d) -> std::size_t {
    if (!std::isfinite(d)) return bins + 2;
    if (d < lower) return bins;
    if (d > upper) return bins + 1;
    return std::min(static_cast<std::size_t>((d - lower) * per_unit), bins - 1);
  });
  const auto bins_end = of.begin() + static_cast<std::ptrdiff_t>(bins);
  return {.lower = lower,
          .upper = upper,
          .area_fractions = {of.begin(), bins_end},
          .below = of[bins],
          .above = of[bins + 1],
          .without_value = of[bins + 2]};
}

}  // namespace sdm

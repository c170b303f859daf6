// Comparison of maps and closest points with expected distances.
#pragma once

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <vector>

#include "core/parallel.h"

namespace sdm::test {

/// Counts disagreements and keeps the worst, for one message per map.
class Disagreements {
 public:
  explicit Disagreements(double tolerance) : tolerance_(tolerance) {}
  void compare(std::size_t index, double actual, double expected);
  /// Succeeds when there are none.
  [[nodiscard]] testing::AssertionResult none() const;

 private:
  double tolerance_;
  std::size_t count_ = 0, worst_index_ = 0;
  double worst_ = 0, worst_actual_ = 0, worst_expected_ = 0;
};

/// Distance from a point to the site; NaN when there is no such site.
[[nodiscard]] double distance_to_site(const Sites& sites, SiteType type, std::uint32_t site,
                                      const Vec3& point);

/// Fails unless, at every texel: distance within `tolerance` of the expected (one a sample), |vector| =
/// |distance|, and sample + vector on the site named; and unless texels without owner hold nothing.
void expect_map(const Surface& surface, const Sites& sites, const DistanceMap& map,
                const std::vector<double>& expected, double tolerance);

/// The same for closest points.
void expect_closest_points(const Sites& sites, const std::vector<Vec3>& queries,
                           const std::vector<ClosestPoint>& closest, const std::vector<double>& expected,
                           double tolerance);

/// expected[i] = oracle(points[i]), on all cores.
template <class Oracle>
[[nodiscard]] std::vector<double> evaluate(const Oracle& oracle, const std::vector<Vec3>& points) {
  std::vector<double> values(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) values[i] = oracle(points[i]);
  });
  return values;
}

}  // namespace sdm::test

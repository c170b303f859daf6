// Test meshes, and the invariants of every map.
#pragma once

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <random>
#include <string>

namespace sdm::test {

/// A mesh of the test folder, placed by the steps of scenes::parse_placement.
[[nodiscard]] Mesh load(const std::string& name, std::string_view steps = "");
[[nodiscard]] Mesh placed(Mesh mesh, std::string_view steps);
/// The same points, moved by the same steps; `fit` has no meaning for them.
[[nodiscard]] std::vector<Vec3> placed(const std::vector<Vec3>& points, std::string_view steps);

[[nodiscard]] Mesh cube(double half_side = 1);
/// An icosahedron, each face cut into 4^levels, on the unit sphere.
[[nodiscard]] Mesh sphere(int levels);
[[nodiscard]] Mesh soup(std::size_t triangles, std::mt19937& random);
[[nodiscard]] Mesh joined(const Mesh& a, const Mesh& b);
/// Every face turned, or every n-th only.
[[nodiscard]] Mesh turned(Mesh mesh, std::size_t every = 1);

[[nodiscard]] Vec3 random_point(const Box& box, std::mt19937& random);
/// Uniform in area.
[[nodiscard]] std::vector<Vec3> random_surface_points(const Mesh& mesh, std::size_t count,
                                                      std::mt19937& random);
[[nodiscard]] std::vector<Vec3> sample_points(const Surface& surface);
[[nodiscard]] double scene_diagonal(const Mesh& o1, const Mesh& o2);

/// Those of engines() that find closest points of any points.
[[nodiscard]] std::vector<std::string> engine_names();
[[nodiscard]] std::string engine_name(const testing::TestParamInfo<std::string>& parameter);

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
[[nodiscard]] std::vector<double> evaluate(const Oracle& oracle, const std::vector<Vec3>& points);

}  // namespace sdm::test

#include "core/parallel.h"

template <class Oracle>
std::vector<double> sdm::test::evaluate(const Oracle& oracle, const std::vector<Vec3>& points) {
  std::vector<double> values(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) values[i] = oracle(points[i]);
  });
  return values;
}

#include "support/map_checks.h"

#include <cmath>

#include "support/oracle.h"

namespace sdm::test {

void Disagreements::compare(std::size_t index, double actual, double expected) {
  const double difference = std::abs(actual - expected);
  if (difference <= tolerance_) return;  // NaN is a disagreement
  ++count_;
  if (count_ == 1 || difference > worst_ || std::isnan(difference)) {
    worst_ = difference;
    worst_index_ = index;
    worst_actual_ = actual;
    worst_expected_ = expected;
  }
}

testing::AssertionResult Disagreements::none() const {
  if (count_ == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << count_ << " disagree by more than " << tolerance_
                                     << "; the worst, number " << worst_index_ << ", is " << worst_actual_
                                     << " instead of " << worst_expected_;
}

double distance_to_site(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& point) {
  const Mesh& mesh = sites.mesh();
  const auto at = [&](std::uint32_t v) { return mesh.positions[v]; };
  if (type == SiteType::vertex && site < mesh.positions.size()) return norm(point - at(site));
  if (type == SiteType::edge && site < sites.edges().size())
    return oracle::distance(point, at(sites.edges()[site][0]), at(sites.edges()[site][1]));
  if (type == SiteType::face && site < mesh.triangles.size()) {
    const auto& [a, b, c] = mesh.triangles[site];
    return oracle::distance(point, at(a), at(b), at(c));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

void expect_map(const Surface& surface, const Sites& sites, const DistanceMap& map,
                const std::vector<double>& expected, double tolerance) {
  const std::size_t texels = surface.map_faces().size();
  ASSERT_EQ(map.texels(), std::size_t{surface.resolution()} * surface.rows());
  ASSERT_EQ(map.resolution, surface.resolution());
  ASSERT_EQ(map.distance.size(), texels);
  ASSERT_EQ(map.vector.size(), texels);
  ASSERT_EQ(map.site.size(), texels);
  ASSERT_EQ(map.site_type.size(), texels);
  ASSERT_EQ(expected.size(), surface.sample_texels().size());
  EXPECT_EQ(map.beyond_max_distance, 0u);

  Disagreements distances(tolerance), sites_named(tolerance);
  Disagreements lengths(4 * std::numeric_limits<float>::epsilon());  // relative: both are rounded to float
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::uint32_t t = surface.sample_texels()[i];
    const Vec3 vector{map.vector[t][0], map.vector[t][1], map.vector[t][2]};
    const double distance = std::abs(map.distance[t]), length = norm(vector);
    distances.compare(i, distance, expected[i]);
    lengths.compare(i, distance > 0 ? length / distance : 1 + length, 1);
    sites_named.compare(
        i, distance_to_site(sites, map.site_type[t], map.site[t], surface.texel_point(t) + vector), 0);
  }
  EXPECT_TRUE(distances.none()) << "distances";
  EXPECT_TRUE(lengths.none()) << "lengths of vectors over distances";
  EXPECT_TRUE(sites_named.none()) << "distances of closest points to the sites named";

  std::size_t stray = 0;
  for (std::size_t t = 0; t < texels; ++t)
    if (surface.map_faces()[t] == kNone)
      stray += !std::isnan(map.distance[t]) || !std::isnan(map.vector[t][0]) || map.site[t] != kNone ||
               map.site_type[t] != SiteType::none;
  EXPECT_EQ(stray, 0u) << "values where no face owns the texel";
}

void expect_closest_points(const Sites& sites, const std::vector<Vec3>& queries,
                           const std::vector<ClosestPoint>& closest, const std::vector<double>& expected,
                           double tolerance) {
  ASSERT_EQ(closest.size(), queries.size());
  ASSERT_EQ(expected.size(), queries.size());
  Disagreements distances(tolerance), lengths(tolerance), sites_named(tolerance), faces_named(tolerance);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const ClosestPoint& c = closest[i];
    distances.compare(i, c.distance, expected[i]);
    lengths.compare(i, norm(c.point - queries[i]), c.distance);
    sites_named.compare(i, distance_to_site(sites, c.type, c.site, c.point), 0);
    faces_named.compare(i, distance_to_site(sites, SiteType::face, c.face, c.point), 0);
  }
  EXPECT_TRUE(distances.none()) << "distances";
  EXPECT_TRUE(lengths.none()) << "|point - query| against distance";
  EXPECT_TRUE(sites_named.none()) << "distances of closest points to the sites named";
  EXPECT_TRUE(faces_named.none()) << "distances of closest points to the faces named";
}

}  // namespace sdm::test

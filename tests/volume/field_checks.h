// Comparisons of fields with that of the reference engine.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "closest/reference/reference_engine.h"
#include "support/oracle.h"
#include "volume/field_by_engine.h"
#include "volume/scenes.h"

namespace sdm::test {

inline constexpr double kFieldTolerance = 2e-6;  // of the diagonal

inline DistanceField reference_field(const Sites& sites, const Grid& grid, const FieldOptions& options = {}) {
  FieldReport unused;
  return volume::field_by_engine(sites, grid, options, reference::ReferenceEngine(), false, unused);
}

/// A point at the border of the maximum distance may have a value or not, one on the surface may have either
/// sign.
inline void expect_equal(const DistanceField& field, const DistanceField& expected, double tolerance) {
  ASSERT_EQ(field.distance.size(), expected.distance.size());
  const auto is_border = [&](float d) { return std::abs(std::abs(d) - field.max_distance) <= tolerance; };
  double worst = 0;
  std::size_t missing = 0, wrong_signs = 0;
  for (std::size_t i = 0; i < field.distance.size(); ++i) {
    const float d = field.distance[i], e = expected.distance[i];
    if (std::isnan(d) || std::isnan(e)) {
      missing += std::isnan(d) != std::isnan(e) && !is_border(std::isnan(d) ? e : d);
    } else {
      worst = std::max(worst, double{std::abs(std::abs(d) - std::abs(e))});
      wrong_signs += std::abs(e) > tolerance && (d < 0) != (e < 0);
    }
  }
  EXPECT_LE(worst, tolerance);
  EXPECT_EQ(missing, 0u);
  EXPECT_EQ(wrong_signs, 0u);
}

inline double distance_to_site(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& p) {
  const std::vector<Vec3>& at = sites.mesh().positions;
  if (type == SiteType::vertex) return norm(at[site] - p);
  if (type == SiteType::edge)
    return oracle::distance(p, at[sites.edges()[site][0]], at[sites.edges()[site][1]]);
  const Triangle& t = sites.mesh().triangles[site];
  return oracle::distance(p, at[t[0]], at[t[1]], at[t[2]]);
}

/// The sites of some points are as far as the field says, within the tolerance.
inline void expect_sites_at_their_distances(const DistanceField& field, const Sites& sites,
                                            double tolerance) {
  ASSERT_EQ(field.site.size(), field.grid.size());
  for_some_points(field.grid, 100, [&](std::size_t i, const Vec3& p) {
    if (std::isnan(field.distance[i])) {
      EXPECT_EQ(field.site_type[i], SiteType::none);
      EXPECT_EQ(field.site[i], kNone);
    } else {
      EXPECT_NEAR(distance_to_site(sites, field.site_type[i], field.site[i], p), std::abs(field.distance[i]),
                  tolerance);
    }
  });
}

}  // namespace sdm::test

// What all measures have in common: maps, counts, and distances at vertices.
#include <gtest/gtest.h>
#include <sdm/measure.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/triangle.h"
#include "support/shapes.h"

namespace sdm {
namespace {

// A plate of thickness 0.5, moved upwards.
Mesh plate(double by) {
  Mesh mesh = test::cube();
  for (Vec3& p : mesh.positions) p[2] = 0.25 * p[2] + by;
  return mesh;
}

struct Parts {
  Mesh o1 = plate(0.01), o2 = plate(0);
  Exclusion exclusion{o1};
  Surface surface{o1, {.resolution = 64}};
  Sites other{o2}, own{o1};

  [[nodiscard]] const Sites& sites(const Measure& measure) const {
    return std::holds_alternative<MapOptions>(measure) || std::holds_alternative<AlongOptions>(measure)
               ? other
               : own;
  }
  [[nodiscard]] std::vector<std::pair<Measure, DistanceKind>> measures() const {
    return {{MapOptions{}, DistanceKind::closest},
            {MapOptions{.facing = 45}, DistanceKind::facing},
            {AlongOptions{}, DistanceKind::along},
            {AlongOptions{.direction = Vec3{0, 0, 1}}, DistanceKind::along},
            {SelfOptions{.exclusion = exclusion}, DistanceKind::self},
            {ThicknessOptions{}, DistanceKind::thickness},
            {ThicknessOptions{.method = ThicknessMethod::ray}, DistanceKind::thickness}};
  }
};

TEST(Measure, EveryOneHasAMapWhoseCountsAreThoseOfItsTexels) {
  const Parts parts;
  for (const auto& [measure, kind] : parts.measures()) {
    const DistanceMap map = compute_map(parts.surface, parts.sites(measure), measure);
    EXPECT_EQ(map.measured.kind, kind);
    EXPECT_FALSE(map.measured.text.empty());
    EXPECT_FALSE(map.sign.reason.empty());
    std::size_t without = 0, unmatched = 0;
    for (const std::uint32_t texel : parts.surface.sample_texels()) {
      const bool none = map.site_type[texel] == SiteType::none;
      ASSERT_EQ(none, !std::isfinite(map.distance[texel]));
      ASSERT_EQ(none, map.site[texel] == kNone);
      without += none;
      unmatched += !map.unmatched.empty() && map.unmatched[texel] != 0;
    }
    EXPECT_EQ(map.beyond_max_distance + map.without_match, without) << map.measured.text;
    EXPECT_EQ(map.without_match, unmatched) << map.measured.text;
    EXPECT_EQ(map.unmatched.empty(), unmatched == 0);
    // Nothing is known of texels that no face owns.
    const std::span<const std::uint32_t> faces = parts.surface.texel_faces();
    for (std::size_t texel = 0; texel < faces.size(); ++texel)
      ASSERT_TRUE(faces[texel] != kNone || std::isnan(map.distance[texel]));
  }
}

TEST(Measure, AtVerticesIsTheLeastOfTheFacesAround) {
  const Parts parts;
  const auto least = [&](const auto& of_points) {
    std::vector<float> values(parts.o1.positions.size(), std::numeric_limits<float>::quiet_NaN());
    for (std::uint32_t f = 0; f < parts.o1.triangles.size(); ++f) {
      const auto [a, b, c] = corners_of(parts.o1, f);
      const std::vector<Vec3> normals(3, cross(b - a, c - a)), points{a, b, c};
      const FacingPoints found = of_points(points, normals);
      for (std::size_t k = 0; k < 3; ++k) {
        if (found.closest[k].type == SiteType::none) continue;
        const auto d =
            static_cast<float>(found.behind[k] != 0 ? -found.closest[k].distance : found.closest[k].distance);
        float& value = values[parts.o1.triangles[f][k]];
        if (std::isnan(value) || std::abs(d) < std::abs(value)) value = d;
      }
    }
    return values;
  };
  const auto same = [](const std::vector<float>& a, const std::vector<float>& b) {
    return std::ranges::equal(a, b,
                              [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  };
  for (const AlongOptions& along : {AlongOptions{}, AlongOptions{.direction = Vec3{0, 0.1, -2}}})
    EXPECT_TRUE(
        same(distances_at_vertices(parts.o1, parts.other, along), least([&](auto points, auto normals) {
               return closest_points_along(parts.other, points, normals, along);
             })));
  const MapOptions facing{.facing = 45};
  EXPECT_TRUE(same(distances_at_vertices(parts.o1, parts.other, Measure(facing)),
                   least([&](auto points, auto normals) {
                     return closest_facing_points(parts.other, points, normals, *facing.facing);
                   })));
  // All faces of a box but two exclude each other; balls have no size at right angles.
  for (const float d : distances_at_vertices(parts.o1, parts.own, SelfOptions{.exclusion = parts.exclusion}))
    EXPECT_TRUE(std::isinf(d) || d >= 0.25F);
  for (const float d :
       distances_at_vertices(parts.o1, parts.own, ThicknessOptions{.method = ThicknessMethod::ray}))
    EXPECT_NEAR(d, 0.5, 1e-6);
}

TEST(Measure, SamplesBoundOnlyTheClosestPoint) {
  using enum DistanceKind;
  for (const DistanceKind kind : {closest, facing, along, thickness, self}) {
    EXPECT_EQ(is_lipschitz(kind), kind == closest);
    EXPECT_EQ(is_provable({.kind = kind, .text = {}, .facing = 45}), kind == closest || kind == facing);
    EXPECT_FALSE(is_provable({.kind = facing}));
    EXPECT_EQ(has_estimated_signs(kind, SignMethod::winding), kind == closest);
    EXPECT_FALSE(has_estimated_signs(kind, SignMethod::exact));
    EXPECT_EQ(lacks_boundary_signs(kind, SignMethod::side), kind == closest);
  }
}

}  // namespace
}  // namespace sdm

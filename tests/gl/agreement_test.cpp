// Every texel of every map by rasterisation against the reference engine.
#include "gl/raster_report.h"
#include "gl/scenes.h"
#include "gl/support.h"
#include "support/map_checks.h"
#include "support/oracle.h"
#include "support/points.h"

namespace sdm {
namespace {

using test::Disagreements;

// The distance of the foot of the perpendicular from q onto a site's line or plane lies from the site itself:
// 0 where q is in the site's region of influence. A face too thin for its plane to mean anything passes.
double foot_beyond_site(const Sites& sites, SiteType type, std::uint32_t site, const Vec3& q) {
  const std::vector<Vec3>& p = sites.mesh().positions;
  if (type == SiteType::edge) {
    const auto [i, j] = sites.edges()[site];
    const Vec3 along = p[j] - p[i];
    return oracle::distance(p[i] + (dot(q - p[i], along) / squared_norm(along)) * along, p[i], p[j]);
  }
  if (type == SiteType::face) {
    const auto [i, j, k] = sites.mesh().triangles[site];
    const Vec3 n = cross(p[j] - p[i], p[k] - p[i]);
    const double longest =
        std::max({squared_norm(p[j] - p[i]), squared_norm(p[k] - p[j]), squared_norm(p[i] - p[k])});
    if (norm(n) < 1e-6 * longest) return 0;
    return oracle::distance(q - (dot(q - p[i], n) / squared_norm(n)) * n, p[i], p[j], p[k]);
  }
  return 0;
}

// The site named is the closest one wherever the two nearest differ by more than the tolerance, if two things
// hold at every texel q:
//  - q's distance to the closure of the site named exceeds the reference's distance by the tolerance at most.
//    Then no site is nearer by more than that: either the names agree, or the two sites named tie.
//  - q lies in the region of the site named. Sites are open, so a face may not be named for a closest point
//  on
//    its edge, although its closure is just as near.
void expect_closest_sites(const Surface& surface, const Sites& sites, const DistanceMap& map,
                          const std::vector<double>& expected, double tolerance) {
  Disagreements nearest(tolerance), feet(tolerance);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::uint32_t t = surface.sample_texels()[i];
    const Vec3 q = surface.texel_point(t);
    const double distance = test::distance_to_site(sites, map.site_type[t], map.site[t], q);
    nearest.compare(i, distance, expected[i]);
    if (!std::isnan(distance))  // there is such a site
      feet.compare(i, foot_beyond_site(sites, map.site_type[t], map.site[t], q), 0);
  }
  EXPECT_TRUE(nearest.none()) << "distances to the sites named";
  EXPECT_TRUE(feet.none()) << "feet of perpendiculars beyond the sites named";
}

// Where the distance is beyond the tolerance, the sign is the reference's.
void expect_signs(const Surface& surface, const DistanceMap& map, const DistanceMap& reference,
                  double tolerance, bool both) {
  EXPECT_EQ(map.sign.method, reference.sign.method);
  EXPECT_EQ(map.sign.reason, reference.sign.reason);
  std::size_t negative = 0, positive = 0, wrong = 0;
  for (const std::uint32_t t : surface.sample_texels()) {
    if (std::abs(reference.distance[t]) <= tolerance) continue;
    ++(reference.distance[t] < 0 ? negative : positive);
    wrong += (map.distance[t] < 0) != (reference.distance[t] < 0);
  }
  EXPECT_EQ(wrong, 0u) << "of " << positive << " outside and " << negative << " inside";
  if (both) {
    EXPECT_GT(negative, 0u);
    EXPECT_GT(positive, 0u);
  }
}

class Agreement : public testing::TestWithParam<test::Scene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Agreement, testing::ValuesIn(test::scenes()), test::scene_name);

TEST_P(Agreement, EveryTexelMatchesTheReference) {
  const test::Scene& scene = GetParam();
  const Surface surface(scene.o1(), scene.atlas);
  const Sites sites(scene.o2());
  const double tolerance = 1e-6 * test::scene_diagonal(surface.mesh(), sites.mesh());
  ASSERT_GT(surface.sample_texels().size(), 40u);

  const DistanceMap reference = compute_map(surface, sites, {.engine = make_engine("reference")});
  std::vector<double> expected;
  for (const std::uint32_t t : surface.sample_texels()) expected.push_back(std::abs(reference.distance[t]));
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    SCOPED_TRACE(clip == GlClip::planes ? "planes" : "stencil");
    const GlOptions options{.clip = clip};
    const test::GlMap map = test::gl_map(surface, sites, options);
    test::expect_map(surface, sites, map, expected, tolerance);
    expect_closest_sites(surface, sites, map, expected, tolerance);
    expect_signs(surface, map, reference, tolerance, scene.both_signs);
    test::expect_laws(map.report, surface, sites, options);
  }
}

// The scenes cover all awkward kinds of meshes.
TEST(Agreement, ScenesCoverAllKindsOfMeshes) {
  bool open = false, nonmanifold = false, degenerate = false, large = false;
  for (const test::Scene& scene : test::scenes()) {
    const MeshInfo info = inspect(scene.o2());
    open |= info.boundary_edges > 0;
    nonmanifold |= info.nonmanifold_edges > 0;
    degenerate |= info.degenerate_faces > 0;
    large |= info.triangles >= 50000;
  }
  EXPECT_TRUE(open && nonmanifold && degenerate && large);
}

TEST(Agreement, WithinAMaximumDistance) {
  const test::Scene& scene = test::scene("Holes");
  const Surface surface(scene.o1(), scene.atlas);
  const Sites sites(scene.o2());
  const double tolerance = 1e-6 * test::scene_diagonal(surface.mesh(), sites.mesh());
  const DistanceMap all = compute_map(surface, sites, {.engine = make_engine("reference")});
  for (const GlClip clip : {GlClip::planes, GlClip::stencil})
    for (const double limit : {0.02, 0.2, 1e-9}) {
      SCOPED_TRACE(limit);
      const test::GlMap near = test::gl_map(surface, sites, GlOptions{.clip = clip}, limit);
      Disagreements distances(tolerance);
      std::size_t beyond = 0, texels_beyond = 0, wrong = 0;
      for (const std::uint32_t t : surface.sample_texels()) {
        if (!std::isnan(near.distance[t])) {
          distances.compare(t, near.distance[t], all.distance[t]);
          wrong += all.distance[t] > limit + tolerance;
          continue;
        }
        ++beyond;
        texels_beyond += t < surface.texel_faces().size();
        wrong += all.distance[t] < limit - tolerance || !std::isnan(near.vector[t][0]) ||
                 near.site[t] != kNone || near.site_type[t] != SiteType::none;
      }
      EXPECT_TRUE(distances.none());
      EXPECT_EQ(wrong, 0u);
      EXPECT_EQ(near.beyond_max_distance, beyond);
      EXPECT_GT(beyond, 0u);
      if (limit > 1e-3) {
        EXPECT_LT(beyond, surface.sample_texels().size());
      }
      const gl::RasterReport& r = near.report;
      EXPECT_EQ(r.pairs, r.culled_by_bound + r.culled_by_obb + r.clipped_away + r.polygons);
      EXPECT_GE(r.fragments, r.texels - texels_beyond);
    }
}

}  // namespace
}  // namespace sdm

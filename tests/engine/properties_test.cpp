// Properties of distance maps of any meshes.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <random>
#include <vector>

#include "support/engines.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

class Properties : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] DistanceMap map(const Surface& surface, const Sites& sites) const {
    return compute_map(surface, sites, {.engine = make_engine(GetParam())});
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, Properties, testing::ValuesIn(test::engine_names_with_gpu()),
                         test::engine_name);

TEST_P(Properties, RigidMotionOfBothPreservesDistances) {
  const char* motion = "rotate:20:-130:77,translate:0.3:-0.4:0.25";
  const Mesh o1 = test::load("head.off", "fit"), o2 = test::load("elephant-with-holes.off", "fit");
  const Sites here(o2), there(test::placed(o2, motion));
  std::mt19937 random(1);
  const std::vector<Vec3> points = test::random_surface_points(o1, 20000, random);
  const auto before = closest_points(here, points, {.engine = make_engine(GetParam())});
  const auto after = closest_points(there, test::placed(points, motion), {.engine = make_engine(GetParam())});
  test::Disagreements distances(1e-6 * test::scene_diagonal(o1, o2));
  for (std::size_t i = 0; i < points.size(); ++i) distances.compare(i, after[i].distance, before[i].distance);
  EXPECT_TRUE(distances.none());
}

// The previous contents may be of another surface, engine or limit.
TEST_P(Properties, ComputingInPlaceEqualsANewMap) {
  const Sites sites(test::load("elephant.off", "fit"));
  const Surface large(test::load("bunny.obj", "fit"), {.resolution = 256});
  const Surface small(test::load("head.off", "fit"), {.resolution = 64});
  DistanceMap reused;
  for (const Surface* surface : {&large, &small, &large})
    for (const double limit : {0.05, std::numeric_limits<double>::infinity()}) {
      const MapOptions options{.engine = make_engine(GetParam()), .max_distance = limit};
      compute_map(*surface, sites, options, reused);
      const DistanceMap fresh = compute_map(*surface, sites, options);
      EXPECT_EQ(reused.resolution, fresh.resolution);
      EXPECT_EQ(reused.site, fresh.site);
      EXPECT_EQ(reused.site_type, fresh.site_type);
      EXPECT_EQ(reused.sign.method, fresh.sign.method);
      EXPECT_EQ(reused.beyond_max_distance, fresh.beyond_max_distance);
      ASSERT_EQ(reused.distance.size(), fresh.distance.size());
      for (std::size_t i = 0; i < fresh.distance.size(); ++i) {
        if (std::isnan(fresh.distance[i])) {
          ASSERT_TRUE(std::isnan(reused.distance[i]) && std::isnan(reused.vector[i][0]));
          continue;
        }
        ASSERT_EQ(reused.distance[i], fresh.distance[i]);
        ASSERT_EQ(reused.vector[i], fresh.vector[i]);
      }
    }
}

TEST_P(Properties, NeighbouringTexelsAreOneLipschitz) {
  const Surface surface(test::load("bunny.obj", "fit"), {.resolution = 256});
  const Sites sites(test::load("elephant.off", "fit"));
  const DistanceMap signed_map = map(surface, sites);
  ASSERT_EQ(signed_map.sign.method, SignMethod::exact);
  const double tolerance = 2e-6 * test::scene_diagonal(surface.mesh(), sites.mesh());
  const std::uint32_t n = surface.resolution();
  std::size_t pairs = 0, steeper = 0;
  const auto compare = [&](std::uint32_t s, std::uint32_t t) {
    if (surface.map_faces()[s] == kNone || surface.map_faces()[t] == kNone) return;
    ++pairs;
    const double apart = norm(surface.texel_point(s) - surface.texel_point(t));
    steeper += !(std::abs(double{signed_map.distance[s]} - signed_map.distance[t]) <= apart + tolerance);
  };
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      compare(y * n + x, y * n + x + 1);
      compare(y * n + x, y * n + x + n);
    }
  EXPECT_GT(pairs, 30000u);
  EXPECT_EQ(steeper, 0u);
}

TEST_P(Properties, RefitEqualsRebuild) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Mesh rest = test::load("elephant.off", "fit");
  // A twist about z: vertices move far from where the tree was built.
  Mesh twisted = rest;
  for (Vec3& p : twisted.positions) {
    const double angle = 4 * p[2], c = std::cos(angle), s = std::sin(angle);
    p = {c * p[0] - s * p[1], s * p[0] + c * p[1], 1.5 * p[2]};
  }
  Sites refitted(rest);
  refitted.refit(twisted.positions);
  const Sites rebuilt(twisted);
  const DistanceMap a = map(surface, refitted), b = map(surface, rebuilt);
  EXPECT_EQ(a.sign.method, b.sign.method);
  test::Disagreements distances(1e-6 * test::scene_diagonal(surface.mesh(), twisted));
  for (const std::uint32_t t : surface.sample_texels()) distances.compare(t, a.distance[t], b.distance[t]);
  EXPECT_TRUE(distances.none());
}

TEST(RejectedRefit, ChangesNothing) {
  const Mesh mesh = test::load("elephant.off", "fit");
  Sites sites(mesh);
  std::vector<Vec3> positions = mesh.positions;
  positions.pop_back();
  EXPECT_THROW(sites.refit(positions), Error);
  positions = mesh.positions;
  for (Vec3& p : positions) p[0] += 5;
  positions.back()[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sites.refit(positions), Error);
  positions.back()[1] = 1e200;
  EXPECT_THROW(sites.refit(positions), Error);
  EXPECT_EQ(sites.mesh().positions, mesh.positions);
  const std::vector<Vec3> query{{5, 0, 0}};
  EXPECT_NEAR(closest_points(sites, query)[0].distance, oracle::brute_force(mesh, query[0]), 1e-6);
}

TEST_P(Properties, DistanceToAUnionIsTheMinimum) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Mesh a = test::load("elephant-with-holes.off", "fit,translate:0.3:0:0");
  const Mesh b = test::load("knot2.off", "fit,translate:-0.3:0.2:0");
  const MapOptions options{.engine = make_engine(GetParam()), .sign = SignMethod::none};
  const DistanceMap to_a = compute_map(surface, Sites(a), options),
                    to_b = compute_map(surface, Sites(b), options),
                    to_both = compute_map(surface, Sites(test::joined(a, b)), options);
  test::Disagreements distances(1e-6 * test::scene_diagonal(surface.mesh(), test::joined(a, b)));
  std::size_t nearer_a = 0;
  for (const std::uint32_t t : surface.sample_texels()) {
    distances.compare(t, to_both.distance[t], std::min(to_a.distance[t], to_b.distance[t]));
    nearer_a += to_a.distance[t] < to_b.distance[t];
  }
  EXPECT_TRUE(distances.none());
  EXPECT_GT(nearer_a, 0u);
  EXPECT_LT(nearer_a, surface.sample_texels().size());
}

TEST_P(Properties, MaxDistanceOmitsAndCountsTexels) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Sites sites(test::load("elephant.off", "fit,translate:0.5:0:0"));
  const DistanceMap all = map(surface, sites);
  const double limit = 0.3, tolerance = 1e-6 * test::scene_diagonal(surface.mesh(), sites.mesh());
  const DistanceMap near =
      compute_map(surface, sites, {.engine = make_engine(GetParam()), .max_distance = limit});
  std::size_t beyond = 0, wrong = 0;
  test::Disagreements distances(tolerance);
  for (const std::uint32_t t : surface.sample_texels()) {
    const double unlimited = std::abs(all.distance[t]);
    if (std::isnan(near.distance[t])) {
      ++beyond;
      wrong += unlimited < limit - tolerance || near.site[t] != kNone ||
               near.site_type[t] != SiteType::none || !std::isnan(near.vector[t][0]);
    } else {
      distances.compare(t, near.distance[t], all.distance[t]);
      wrong += unlimited > limit + tolerance;
    }
  }
  EXPECT_TRUE(distances.none());
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(near.beyond_max_distance, beyond);
  EXPECT_GT(beyond, surface.sample_texels().size() / 10);
  EXPECT_LT(beyond, surface.sample_texels().size());

  const DistanceMap nothing =
      compute_map(surface, sites, {.engine = make_engine(GetParam()), .max_distance = 1e-9});
  EXPECT_EQ(nothing.beyond_max_distance, surface.sample_texels().size());
  const std::vector<Vec3> far{{100, 0, 0}};
  const ClosestPoint none =
      closest_points(sites, far, {.engine = make_engine(GetParam()), .max_distance = 1.0})[0];
  EXPECT_EQ(none.type, SiteType::none);
  EXPECT_EQ(none.site, kNone);
}

TEST_P(Properties, MapEqualsClosestPoints) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 64});
  const Sites sites(test::load("elephant-with-holes.off", "fit"));
  const DistanceMap texels = map(surface, sites);
  const auto closest = closest_points(sites, surface.sample_points(), {.engine = make_engine(GetParam())});
  test::Disagreements distances(1e-6 * test::scene_diagonal(surface.mesh(), sites.mesh()));
  for (std::size_t i = 0; i < closest.size(); ++i)
    distances.compare(i, texels.distance[surface.sample_texels()[i]], closest[i].distance);
  EXPECT_TRUE(distances.none());
}

TEST_P(Properties, DoNotDependOnTheNumberOfThreads) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Sites sites(test::load("elephant.off", "fit"));
  const DistanceMap many = map(surface, sites);
  const ThreadLimit one(1);
  const DistanceMap single = map(surface, sites);
  std::size_t different = 0;
  for (const std::uint32_t t : surface.sample_texels())
    different += many.distance[t] != single.distance[t] || many.vector[t] != single.vector[t] ||
                 many.site[t] != single.site[t] || many.site_type[t] != single.site_type[t];
  EXPECT_EQ(different, 0u);
}

TEST_P(Properties, ProgressCancels) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Sites sites(test::load("elephant.off", "fit"));
  double last = 0;
  const auto watch = [&](std::string_view, double fraction) {
    EXPECT_LE(fraction, 1);
    last = std::max(last, fraction);
    return true;
  };
  (void)compute_map(surface, sites, {.engine = make_engine(GetParam()), .progress = watch});
  EXPECT_GT(last, 0);
  const auto stop = [](std::string_view, double) { return false; };
  EXPECT_THROW((void)compute_map(surface, sites, {.engine = make_engine(GetParam()), .progress = stop}),
               Cancelled);
}

}  // namespace
}  // namespace sdm

// Properties of all maps of the gl engine, and the behaviour of the engine within a process.
#include <atomic>
#include <thread>

#include "gl/scenes.h"
#include "gl/support.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using test::gl_map;

TEST(GlEngine, RigidMotionOfBothPreservesDistances) {
  const Mesh o1 = test::with_own_uvs(test::load("head.off", "fit"), 256);
  const Mesh o2 = test::load("elephant.off", "fit");
  const AtlasOptions atlas{.kind = AtlasKind::uv, .resolution = 256};
  const Surface here(o1, atlas);
  const test::GlMap before = gl_map(here, Sites(o2));
  for (const char* motion :
       {"translate:3:-2:1", "rotate:20:-130:77,translate:0.3:-0.4:0.25", "rotate:90:0:0"}) {
    SCOPED_TRACE(motion);
    const Surface there(test::placed(o1, motion), atlas);
    ASSERT_TRUE(std::ranges::equal(here.texel_faces(), there.texel_faces()));
    const test::GlMap after = gl_map(there, Sites(test::placed(o2, motion)));
    test::Disagreements distances(1e-6 * test::scene_diagonal(o1, o2));
    for (const std::uint32_t t : here.sample_texels())
      distances.compare(t, after.distance[t], before.distance[t]);
    EXPECT_TRUE(distances.none());
  }
}

TEST(GlEngine, NeighbouringTexelsAreOneLipschitz) {
  const test::Scene& scene = test::scene("Penetrating");
  const Surface surface(scene.o1(), scene.atlas);
  const test::GlMap map = gl_map(surface, Sites(scene.o2()));
  const std::uint32_t n = surface.resolution();
  std::size_t pairs = 0, steeper = 0;
  for (std::uint32_t t = 0; t + n < n * n; ++t)
    for (const std::uint32_t next : {t + 1, t + n}) {
      if (surface.map_faces()[t] == kNone || surface.map_faces()[next] == kNone) continue;
      ++pairs;
      const double apart = norm(surface.texel_point(t) - surface.texel_point(next));
      steeper += !(std::abs(double{map.distance[t]} - map.distance[next]) <= apart + 4e-6);
    }
  EXPECT_GT(pairs, 30000u);
  EXPECT_EQ(steeper, 0u);
}

TEST(GlEngine, RefitEqualsRebuild) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Mesh rest = test::load("elephant.off", "fit");
  Mesh twisted = rest;  // about z: vertices move far from where the tree was built
  for (Vec3& p : twisted.positions) {
    const double angle = 4 * p[2], c = std::cos(angle), s = std::sin(angle);
    p = {c * p[0] - s * p[1], s * p[0] + c * p[1], 1.5 * p[2]};
  }
  Sites refitted(rest);
  (void)gl_map(surface, refitted);  // whatever the engine keeps must follow
  refitted.refit(twisted.positions);
  const test::GlMap a = gl_map(surface, refitted), b = gl_map(surface, Sites(twisted));
  test::Disagreements distances(1e-6 * test::scene_diagonal(surface.mesh(), twisted));
  for (const std::uint32_t t : surface.sample_texels()) distances.compare(t, a.distance[t], b.distance[t]);
  EXPECT_TRUE(distances.none());
}

TEST(GlEngine, ConsecutiveMapsMayDifferInSize) {
  const Sites sites(test::load("elephant.off", "fit"));
  const Surface small(test::load("head.off", "fit"), {.resolution = 64});
  const Surface large(test::cube(0.4), {.resolution = 512});
  const test::GlMap first_small = gl_map(small, sites), first_large = gl_map(large, sites);
  for (const GlClip clip : {GlClip::stencil, GlClip::planes})
    for (int i = 0; i < 2; ++i) {
      const test::GlMap again_small = gl_map(small, sites, {.clip = clip});
      const test::GlMap again_large = gl_map(large, sites, {.clip = clip});
      EXPECT_TRUE(test::identical(first_small, again_small));
      EXPECT_TRUE(test::identical(first_large, again_large));
    }
}

TEST(GlEngine, MapsFromConcurrentThreads) {
  const Sites elephant(test::load("elephant.off", "fit")), box(test::cube(0.3));
  const Surface head(test::load("head.off", "fit"), {.resolution = 128});
  const Surface ball(test::sphere(2), {.resolution = 64});
  const test::GlMap head_alone = gl_map(head, elephant), ball_alone = gl_map(ball, box);
  const auto repeat = [](const Surface& surface, const Sites& sites, const DistanceMap& expected,
                         GlClip clip) {
    for (int i = 0; i < 5; ++i) {
      const test::GlMap map = gl_map(surface, sites, {.clip = clip});
      EXPECT_TRUE(test::identical(map, expected));
      EXPECT_EQ(map.report.texels, surface.owned_texels());
    }
  };
  std::thread first([&] { repeat(head, elephant, head_alone, GlClip::planes); });
  std::thread second([&] { repeat(ball, box, ball_alone, GlClip::stencil); });
  repeat(ball, box, ball_alone, GlClip::planes);
  first.join();
  second.join();
}

TEST(GlEngine, ProgressIsReportedFromOneThreadAtATime) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 256});
  const Sites sites(test::load("elephant.off", "fit"));
  std::atomic<int> within = 0;
  int calls = 0;
  double last = 0;
  const auto watch = [&](std::string_view step, double fraction) {
    EXPECT_EQ(within.fetch_add(1), 0);
    EXPECT_FALSE(step.empty());
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    ++calls;
    last = fraction;
    --within;
    return true;
  };
  MapOptions options{.engine = make_engine("gl")};
  options.progress = watch;
  (void)compute_map(surface, sites, options);
  EXPECT_EQ(gl_report(*options.engine).value().unconfirmed, 0u);
  EXPECT_GT(calls, 2);
  EXPECT_EQ(last, 1);
}

TEST(GlEngine, CanCancelAtAnyProgressCall) {
  const Surface surface(test::load("head.off", "fit"), {.resolution = 128});
  const Sites sites(test::load("elephant.off", "fit"));
  for (const GlClip clip : {GlClip::planes, GlClip::stencil}) {
    const test::GlMap whole = gl_map(surface, sites, {.clip = clip});
    const auto stop_at = [&](int last) {  // the number of calls; negative `last` never stops
      int calls = 0;
      const auto watch = [&](std::string_view, double) { return ++calls != last; };
      MapOptions options{.engine = make_gl_engine({.clip = clip})};
      options.progress = watch;
      if (last < 0)
        (void)compute_map(surface, sites, options);
      else
        EXPECT_THROW((void)compute_map(surface, sites, options), Cancelled) << "at call " << last;
      return calls;
    };
    const int calls = stop_at(-1);
    for (const int last : {1, 2, calls / 4, calls / 2}) {
      stop_at(last);
      const test::GlMap map = gl_map(surface, sites, {.clip = clip});
      EXPECT_TRUE(test::identical(map, whole));
      test::expect_same_counts(map.report, whole.report);
    }
  }
}

TEST(GlEngine, ReportsItsLastMap) {
  const Surface small(test::cube(), {.resolution = 16}), large(test::cube(), {.resolution = 32});
  const Sites sites(test::sphere(1));
  const auto gl = make_engine("gl"), cpu = make_engine("cpu");
  EXPECT_FALSE(gl_report(*gl)) << "no map yet";
  for (const Surface* surface : {&small, &large}) {
    (void)gl_map(*surface, sites, gl);
    (void)compute_map(*surface, sites, {.engine = cpu});
    EXPECT_EQ(gl_report(*gl).value().texels, surface->owned_texels());
    EXPECT_FALSE(gl_report(*cpu)) << "of another engine";
  }
}

TEST(GlEngine, ReportsCountsByName) {
  const Surface surface(test::cube(), {.resolution = 16});
  const auto engine = make_engine("gl");
  (void)gl_map(surface, Sites(test::sphere(1)), engine);
  const GlReport report = gl_report(*engine).value();
  const auto number = [](const auto& named, std::string_view name) {
    return std::ranges::find_if(named, [&](const auto& n) { return n.first == name; })->second;
  };
  EXPECT_EQ(number(report.counts, "pairs"), number(report.counts, "culled_by_bound") +
                                                number(report.counts, "culled_by_obb") +
                                                number(report.counts, "clipped_away") + report.polygons);
  EXPECT_GT(report.polygons, 0u);
  EXPECT_GE(report.fragments, report.texels);
  EXPECT_GT(number(report.time_ms, "draw"), 0);
}

}  // namespace
}  // namespace sdm

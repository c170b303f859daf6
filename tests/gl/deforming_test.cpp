// Sequences of frames in which both meshes deform: every texel of every frame against the reference engine.
#include <cmath>
#include <numbers>

#include "gl/support.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

constexpr int kFrames = 20;

// Twists about z, back and forth, and stretches along it.
std::vector<Vec3> twisted(std::vector<Vec3> positions, double time) {
  const double swing = std::sin(2 * std::numbers::pi * time);
  for (Vec3& p : positions) {
    const double angle = 2 * swing * p[2], c = std::cos(angle), s = std::sin(angle);
    p = {c * p[0] - s * p[1], s * p[0] + c * p[1], (1 + 0.4 * time) * p[2]};
  }
  return positions;
}

// Bends in the plane y = 0, carried from one side of the other mesh to the far side.
std::vector<Vec3> bent(std::vector<Vec3> positions, double time) {
  const double curvature = 0.2 + time, radius = 1 / curvature;
  for (Vec3& p : positions) {
    const double angle = curvature * p[0], r = radius - p[2];
    p = {r * std::sin(angle) + 5 * time - 2.5, p[1], radius - r * std::cos(angle)};
  }
  return positions;
}

class Deforming : public testing::TestWithParam<GlClip> {};
INSTANTIATE_TEST_SUITE_P(Clips, Deforming, testing::Values(GlClip::planes, GlClip::stencil),
                         [](const auto& clip) {
                           return std::string(clip.param == GlClip::planes ? "planes" : "stencil");
                         });

TEST_P(Deforming, EveryTexelOfEveryFrameMatchesTheReference) {
  // With coordinates of its own, a surface built from a frame has the texels of one that was refitted to it.
  Mesh o1 = test::with_own_uvs(test::load("head.off", "fit"), 128);
  Mesh o2 = test::load("elephant.off", "fit");
  const std::vector<Vec3> rest1 = o1.positions, rest2 = o2.positions;
  const AtlasOptions atlas{.kind = AtlasKind::uv, .resolution = 128};
  Surface surface(o1, atlas);
  Sites sites(o2);
  const auto engine = make_gl_engine({.clip = GetParam()});
  std::size_t touching = 0, apart = 0;  // frames in which O1 is partly inside O2, and in which it is not
  for (int frame = 0; frame < kFrames; ++frame) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    const double time = static_cast<double>(frame) / (kFrames - 1);
    o1.positions = twisted(rest1, time);
    o2.positions = bent(rest2, time);
    surface.refit(o1.positions);
    sites.refit(o2.positions);
    const test::GlMap map = test::gl_map(surface, sites, engine);

    const Surface rebuilt(o1, atlas);
    ASSERT_TRUE(std::ranges::equal(surface.texel_faces(), rebuilt.texel_faces()));
    const DistanceMap reference = compute_map(rebuilt, Sites(o2), {.engine = make_engine("reference")});
    std::vector<double> expected;
    bool inside = false;
    for (const std::uint32_t t : surface.sample_texels()) {
      expected.push_back(std::abs(reference.distance[t]));
      inside |= reference.distance[t] < 0;
    }
    ++(inside ? touching : apart);
    const double tolerance = 1e-6 * test::scene_diagonal(o1, o2);
    test::expect_map(surface, sites, map, expected, tolerance);
    test::expect_laws(map.report, surface, sites, {.clip = GetParam()});
  }
  EXPECT_GT(touching, 4u);
  EXPECT_GT(apart, 1u);
}

}  // namespace
}  // namespace sdm

// The paper's Algorithm 1 as printed, and what each correction to it changes. The expectations follow from
// the geometry: interpolated vectors to a site end in its convex hull, which is the site, so the distance is
// never too small; those to its plane or line are exact within its region, and too short beyond.
#include <cmath>

#include "geometry/vec.h"
#include "gl/gl_engine.h"
#include "gl/support.h"
#include "support/error_of.h"
#include "support/map_checks.h"
#include "support/points.h"

namespace sdm {
namespace {

using gl::Corrections;

struct Differences {
  std::size_t texels = 0, above = 0, below = 0, without = 0;
};

/// As printed, but for tiles and the texels of a stencil: long, thin polygons on whole planes cannot be
/// interpolated accurately, and a rasterised triangle may lack texels at its sides.
Corrections printed() {
  Corrections corrections = Corrections::none();
  corrections.tiles = corrections.stencil_points = true;
  return corrections;
}

class PaperLiteral : public testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] DistanceMap map(const Corrections& corrections) const {
    const auto engine = gl::make_gl_engine({.clip = GlClip::stencil}, corrections);
    return compute_map(surface_, sites_, {.engine = engine, .sign = SignMethod::none});
  }
  [[nodiscard]] Differences against_exact(const DistanceMap& found, double relative_tolerance = 2e-6) const {
    const double tolerance = relative_tolerance * test::scene_diagonal(surface_.mesh(), sites_.mesh());
    Differences d;
    for (const std::uint32_t t : surface_.sample_texels()) {
      ++d.texels;
      d.without += found.site_type[t] == SiteType::none;
      d.above += found.distance[t] > exact_.distance[t] + tolerance;
      d.below += found.distance[t] < exact_.distance[t] - tolerance;
    }
    return d;
  }
  Surface surface_{test::scene(GetParam()).o1(), {.resolution = 128}};
  Sites sites_{test::scene(GetParam()).o2()};
  DistanceMap exact_ =
      compute_map(surface_, sites_, {.engine = make_engine("reference"), .sign = SignMethod::none});
};
INSTANTIATE_TEST_SUITE_P(Scenes, PaperLiteral, testing::Values("Penetrating", "Soup", "BoxesCrossing"),
                         [](const auto& scene) { return scene.param; });

TEST_P(PaperLiteral, AsPrintedIsNeverTooSmallAndSometimesTooLarge) {
  // Vectors are interpolated in single precision, across polygons as large as the scene: one texel of these
  // scenes is 4e-6 too small.
  const Differences d = against_exact(map(printed()), 1e-5);
  EXPECT_GT(d.above, 0u);
  EXPECT_EQ(d.below, 0u);
}

TEST_P(PaperLiteral, AffineVectorsInBoxesAreNeverTooLargeAndSometimesTooSmall) {
  Corrections affine = printed();
  affine.affine_vectors = true;
  const Differences d = against_exact(map(affine));
  EXPECT_EQ(d.above, 0u);
  EXPECT_GT(d.below, 0u);
}

TEST_P(PaperLiteral, ClippedByRegionsItIsAlmostExact) {
  Corrections walls = printed();
  walls.region_walls = true;
  const Differences d = against_exact(map(walls));
  EXPECT_LE(d.above + d.below + d.without, d.texels / 50);
}

TEST_P(PaperLiteral, ConfirmationRepairsVectorsThatAreTooShort) {
  Corrections without_walls;
  without_walls.region_walls = false;
  const auto engine = gl::make_gl_engine({}, without_walls);
  const Differences d =
      against_exact(compute_map(surface_, sites_, {.engine = engine, .sign = SignMethod::none}));
  EXPECT_EQ(d.above + d.below + d.without, 0u);
  EXPECT_GT(gl_report(*engine).value().unconfirmed, 0u);
}

// The other corrections leave a map exact if they are removed alone.
TEST_P(PaperLiteral, TilesAndInterpolationDoNotAffectTheResult) {
  for (bool Corrections::*correction : {&Corrections::tiles, &Corrections::fragment_vectors}) {
    Corrections others;
    others.*correction = false;
    const Differences d = against_exact(map(others));
    EXPECT_EQ(d.above + d.below + d.without, 0u);
  }
}

TEST_P(PaperLiteral, VectorsHaveTheLengthOfTheDistance) {
  const DistanceMap drawn = map(Corrections::none());
  test::Disagreements lengths(1e-6 * test::scene_diagonal(surface_.mesh(), sites_.mesh()));
  for (const std::uint32_t t : surface_.sample_texels()) {
    if (drawn.site_type[t] == SiteType::none) continue;
    const Vec3 vector{drawn.vector[t][0], drawn.vector[t][1], drawn.vector[t][2]};
    lengths.compare(t, norm(vector), drawn.distance[t]);
  }
  EXPECT_TRUE(lengths.none());
}

// The public option selects all of this, and claims no accuracy.
TEST_P(PaperLiteral, OptionLeavesOutAllCorrections) {
  const auto literal = make_gl_engine({.paper_literal = true});
  const DistanceMap found = compute_map(surface_, sites_, {.engine = literal, .sign = SignMethod::none});
  EXPECT_TRUE(test::identical(found, map(Corrections::none())));
  EXPECT_TRUE(std::isinf(engine_info(*literal).relative_error));
  EXPECT_EQ(engine_info(*literal).name, "gl");
  const GlReport report = gl_report(*literal).value();
  EXPECT_TRUE(report.paper_literal);
  EXPECT_EQ(report.clip, GlClip::stencil);
  EXPECT_EQ(report.unconfirmed, 0u);
  EXPECT_EQ(report.tiles, report.faces);

  const auto exact = make_gl_engine({.clip = GlClip::stencil});
  EXPECT_TRUE(test::identical(map(Corrections{}),
                              compute_map(surface_, sites_, {.engine = exact, .sign = SignMethod::none})));
  EXPECT_FALSE(gl_report(*exact).value().paper_literal);
}

TEST(Corrections, FragmentsEvaluateAffineVectorsOnly) {
  Corrections corrections;
  corrections.affine_vectors = false;
  EXPECT_NE(test::error_of([&] { return gl::make_gl_engine({}, corrections); }), "");
}

}  // namespace
}  // namespace sdm

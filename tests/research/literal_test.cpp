// The paper's Algorithm 1 as printed, and what each correction to it changes. The expectations follow from
// the geometry: interpolated vectors to a site end in its convex hull, which is the site, so the distance is
// never too small; those to its plane or line are exact within its region, and too short beyond.
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/samples.h"
#include "gl/raster_report.h"
#include "gl/scenes.h"
#include "gl/support.h"
#include "research/literal/literal_engine.h"
#include "research/run_sdm_paper.h"
#include "support/error_of.h"
#include "support/map_checks.h"
#include "support/points.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using literal::Corrections;

/// Interpolates from unsnapped corners. Graphics cards snap them to a grid of 1/256 texel, which changes more
/// texels than the errors that are tested here.
constexpr const char* kDevice = "llvmpipe";

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
    const auto engine = literal::make_engine({.device = kDevice}, corrections);
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
  const auto engine = literal::make_engine({.device = kDevice}, without_walls);
  const Differences d =
      against_exact(compute_map(surface_, sites_, {.engine = engine, .sign = SignMethod::none}));
  EXPECT_EQ(d.above + d.below + d.without, 0u);
  EXPECT_GT(literal::report(*engine).value().unconfirmed, 0u);
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

TEST_P(PaperLiteral, AsPrintedClaimsNoAccuracy) {
  const auto printed = literal::make_engine({.device = kDevice}, Corrections::none());
  (void)compute_map(surface_, sites_, {.engine = printed, .sign = SignMethod::none});
  EXPECT_TRUE(std::isinf(engine_info(*printed).relative_error));
  const gl::RasterReport report = literal::report(*printed).value();
  EXPECT_EQ(report.clip, GlClip::stencil);
  EXPECT_EQ(report.unconfirmed, 0u);
  EXPECT_EQ(report.tiles, report.faces);
  EXPECT_EQ(report.pairs,
            report.culled_by_bound + report.culled_by_obb + report.clipped_away + report.polygons);
}

TEST_P(PaperLiteral, WithAllCorrectionsItIsTheEngine) {
  const auto exact = make_gl_engine({.device = kDevice, .clip = GlClip::stencil});
  EXPECT_TRUE(test::identical(map(Corrections{}),
                              compute_map(surface_, sites_, {.engine = exact, .sign = SignMethod::none})));
}

TEST(LiteralCommand, ReportsItsErrors) {
  const test::TemporaryFolder folder;
  const std::string o1 = test::write_obj(folder / "o1.obj", test::scene("Penetrating").o1()),
                    o2 = test::write_obj(folder / "o2.obj", test::scene("Penetrating").o2()),
                    out = folder / "out";
  const auto wrong = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"literal", o1, o2, "-o", out, "--resolution", "64", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome run = test::run_sdm_paper(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(test::names_in(out), (std::vector<std::string>{"map.exr", "report.json"}));
    return nlohmann::json::parse(run.out)["errors"]["wrong_percent"].get<double>();
  };
  EXPECT_GT(wrong({}), 0);
  EXPECT_EQ(wrong({"--with",
                   "region-walls,affine-vectors,fragment-vectors,margins,tiles,stencil-points,confirmation"}),
            0);
  EXPECT_EQ(test::run_sdm_paper({"literal", o1, o2, "-o", out, "--with", "luck"}).code, 2);
}

TEST(Corrections, FragmentsEvaluateAffineVectorsOnly) {
  Corrections corrections;
  corrections.affine_vectors = false;
  EXPECT_NE(test::error_of([&] { return literal::make_engine({}, corrections); }), "");
}

}  // namespace
}  // namespace sdm

// Certified answers, tolerances, statistics and summaries: one small case for each query, against closed
// forms or independent bounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/hausdorff_oracle.h"
#include "support/made_up_maps.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

void expect_bounds(const BoundedNumber& number, double truth, double slack = 1e-9) {
  EXPECT_LE(number.lower, truth + slack);
  EXPECT_GE(number.upper, truth - slack);
}

TEST(SmokeHausdorff, OfCubesIsThatOfTheirFacesAndCorners) {
  const Mesh small = cube(1), large = cube(1.1);
  expect_bounds(one_sided_hausdorff(small, Sites(large)).distance, 0.1);
  expect_bounds(one_sided_hausdorff(large, Sites(small)).distance, 0.1 * std::sqrt(3.0));
  const SymmetricHausdorff both = symmetric_hausdorff(Sites(small), Sites(large));
  expect_bounds(both.larger.distance, 0.1 * std::sqrt(3.0));
  EXPECT_EQ(both.larger_from, 1);
  EXPECT_LT(both.larger.distance.upper - both.larger.distance.lower, 1e-5);
  EXPECT_NEAR(norm((*both.larger.distance.witness)[0] - (*both.larger.distance.witness)[1]),
              both.larger.distance.value, 1e-12);
}

TEST(SmokeHausdorff, OfAwkwardMeshesIsWithinIndependentBounds) {
  std::vector<Mesh> meshes{single_triangle(), square(1, 0.3), cube(0.5), taken_apart(tetrahedron(), 0)};
  for (const std::size_t count : {3, 7, 17}) meshes.push_back(first_faces(sphere(1), count));
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const Mesh &a = meshes[i], &b = meshes[(3 * i + 1) % meshes.size()];
    const HausdorffDistance found = one_sided_hausdorff(a, Sites(b), {.precision = 1e-4});
    const auto [lower, upper] = oracle::hausdorff_bounds(a, b, 0.03);
    EXPECT_LE(found.distance.lower, upper + 1e-9);
    EXPECT_GE(found.distance.upper, lower - 1e-9);
    EXPECT_LT(found.faces[0], a.triangles.size());
    EXPECT_LT(found.faces[1], b.triangles.size());
  }
}

// Surfaces that cross, and two that are parallel, where the largest distance is attained nearly everywhere.
TEST(SmokeHausdorff, OfFineMeshesIsWithinTheBoundsOfSamples) {
  for (const auto& [a, b] :
       {std::pair{torus(15, 9), moved(torus(16, 11), {0.1, 0.2, 0.1})},
        std::pair{sphere(2), mapped_by(sphere(2), [](const Vec3& p) { return 1.1 * p; })}}) {
    const HausdorffDistance found = one_sided_hausdorff(a, Sites(b), {.precision = 1e-3});
    std::mt19937 random(3);
    double sampled = 0;
    for (const Vec3& p : random_surface_points(a, 300, random))
      sampled = std::max(sampled, oracle::brute_force(b, p));
    EXPECT_GE(found.distance.upper, sampled);
    EXPECT_LT(found.distance.lower, 1.3 * sampled);
    EXPECT_LE(found.distance.upper - found.distance.lower, 1e-3 + 1e-9);
  }
}

// Faces of the rims are higher than 1/1000 of the diagonal: lower ones face as their surroundings do.
TEST(SmokeHausdorff, AmongFacingFacesSeesTheWallOfAPlate) {
  const Mesh plate = weld(grid_block({-2, -2, 0}, {2, 2, 0.1}, 3)).mesh,
             dented = weld(grid_block({-2, -2, 0}, {2, 2, 0.02}, 3)).mesh;
  const HausdorffDistance plain = one_sided_hausdorff(dented, Sites(plate)),
                          facing = one_sided_hausdorff(dented, Sites(plate), {.facing = 60});
  expect_bounds(plain.distance, 0.02, 1e-6);
  expect_bounds(facing.distance, 0.08, 1e-6);
  EXPECT_EQ(facing.faces_without_match, 0u);
  const HausdorffDistance half = one_sided_hausdorff(cube(), Sites(first_faces(cube(), 10)), {.facing = 20});
  EXPECT_EQ(half.faces_without_match, 2u);
  EXPECT_NEAR(half.area_without_match, 1.0 / 6, 1e-12);
}

TEST(SmokeMetrics, OfParallelSquaresAreTheirDistance) {
  const Mesh a = grid_square(1, 0, 3), b = grid_square(1, 0.25, 2);
  const MetricsOptions options{.percentiles = {50, 95}, .tolerances = {0.2, 0.3}};
  const SurfaceMetrics metrics = surface_metrics(a, b, options);
  for (const BoundedNumber& number :
       {metrics.hausdorff, metrics.assd, metrics.masd, metrics.rmsd, metrics.percentiles[0],
        metrics.percentiles[1], metrics.from[0].mean, metrics.from[1].rms})
    expect_bounds(number, 0.25, 1e-4);
  expect_bounds(metrics.chamfer_l1, 0.5, 1e-4);
  expect_bounds(metrics.chamfer_l2, 0.125, 1e-4);
  expect_bounds(metrics.surface_dice[0], 0);
  expect_bounds(metrics.surface_dice[1], 1);
  expect_bounds(metrics.f_score[1], 1);
  EXPECT_NEAR(metrics.normal_consistency, 1, 1e-9);
  EXPECT_NEAR(metrics.from[0].area, 1, 1e-12);
  const std::vector<NamedMetric> named = named_metrics(metrics, options);
  const auto recall = std::ranges::find(named, "recall(0.3)", &NamedMetric::name);
  ASSERT_NE(recall, named.end());
  EXPECT_EQ(recall->unit, MetricUnit::fraction);
  EXPECT_EQ(percentile_name(99.5), "hd99.5");
  EXPECT_EQ(metric_name("nsd", 0.5), "nsd(0.5)");
  EXPECT_EQ(surface_metrics({}, {}, options).hausdorff.value, 0);
  EXPECT_EQ(surface_metrics(a, {}, options).surface_dice[0].value, 0);
}

TEST(SmokeMetrics, OfCrossingMeshesHoldTheMeansOfRandomPoints) {
  const Mesh a = torus(9, 7), b = moved(sphere(1), {1.8, 0, 0});
  const SurfaceMetrics metrics = surface_metrics(
      a, b, {.percentiles = {90}, .tolerances = {0.4}, .precision = 0.02, .fraction_precision = 0.02});
  std::mt19937 random(7);
  const std::vector<Vec3> points = random_surface_points(a, 2000, random);
  double mean = 0, within = 0;
  for (const Vec3& p : points) {
    const double d = oracle::brute_force(b, p);
    mean += d / 2000;
    within += d <= 0.4 ? 1.0 / 2000 : 0;
  }
  expect_bounds(metrics.from[0].mean, mean, 0.08);
  expect_bounds(metrics.from[0].within[0], within, 0.04);
  EXPECT_LE(metrics.from[0].mean.upper - metrics.from[0].mean.lower, 0.021);
}

TEST(SmokeTolerance, ProofsDecideOnEitherSideOfTheTruth) {
  const Mesh small = cube(1), large = cube(1.1);
  const Sites sites(large);
  EXPECT_EQ(prove_tolerance(small, sites, Tolerance(-0.1001, 0)).proof, Proof::holds);
  const ToleranceProof outside = prove_tolerance(small, sites, Tolerance(-0.0999, 0));
  EXPECT_EQ(outside.proof, Proof::fails);
  EXPECT_TRUE(outside.at_lower);
  EXPECT_NEAR(outside.witness->distance, -0.1, 1e-4);
  EXPECT_EQ(prove_tolerance(small, sites, 0.0995, {.accuracy = 1e-3}).proof, Proof::undecided);
  EXPECT_EQ(prove_tolerance(large, Sites(small), Tolerance(0, 0.1)).proof, Proof::fails);
  const std::vector<std::uint32_t> faces{3, 7};
  EXPECT_EQ(prove_tolerance(moved(cube(), {0, 0, 0.2}), Sites(cube()), 0.3, {.faces = faces}).proof,
            Proof::holds);
  EXPECT_NE(prove_tolerance(cube(), Sites(cube()), Tolerance(-1, 1e-9), {.most_parts = 3}).proof,
            Proof::fails);
  // Signs by normals of an open mesh: |d| decides, or that all points have the sign that is within the
  // limits.
  const Sites open(grid_square(4, 0.5, 5));
  const Mesh below = grid_square(1, 0, 3);
  EXPECT_EQ(prove_tolerance(below, open, 0.6, {.sign = SignMethod::side}).proof, Proof::holds);
  EXPECT_EQ(prove_tolerance(below, open, Tolerance(-1, 0.1), {.sign = SignMethod::side}).proof, Proof::holds);
  EXPECT_TRUE(prove_tolerance(below, open, Tolerance(-0.1, 1), {.sign = SignMethod::side}).depends_on_signs);
  // The other skin of a thin plate does not count.
  const Mesh plate = weld(grid_block({-2, -2, 0}, {2, 2, 0.1}, 3)).mesh,
             dented = weld(grid_block({-2, -2, 0}, {2, 2, 0.02}, 3)).mesh;
  EXPECT_EQ(prove_tolerance(dented, Sites(plate), 0.05).proof, Proof::holds);
  EXPECT_EQ(prove_tolerance(dented, Sites(plate), 0.05, {.facing = 60}).proof, Proof::fails);
  EXPECT_EQ(prove_tolerance(cube(), Sites(first_faces(cube(), 10)), 0.5, {.facing = 20}).faces_without_match,
            2u);
}

/// O1 in two groups: the left half is `off` above O2, the right half on it.
struct TwoGroups {
  explicit TwoGroups(double off) : o1(grid_square(1, 0, 4)) {
    for (Vec3& p : o1.positions)
      if (p[0] < -1e-9) p[2] = off;
    names.push_back({.kind = "group", .names = {"left", "right"}, .of_face = {}});
    for (std::size_t f = 0; f < o1.triangles.size(); ++f) names[0].of_face.push_back(f < 16 ? 0 : 1);
  }
  Mesh o1;
  std::vector<FaceNames> names;
  Sites sites{grid_square(3, 0, 3)};
};

TEST(SmokeTolerance, VerdictsOfMapsAndGroupsAreThoseOfTheTruth) {
  const TwoGroups pair(0.1);
  const Surface surface(pair.o1, {.resolution = 33});
  const DistanceMap map = compute_map(surface, pair.sites);
  const std::vector<float> vertices = distances_at_vertices(pair.o1, pair.sites);
  const double bound = covering_radius(surface),
               accuracy = engine_accuracy(engines()[0], pair.o1, pair.sites.mesh());
  const CertifyOptions options{.error_bound = bound, .accuracy = accuracy};
  EXPECT_EQ(certify_tolerance(surface, pair.sites, map, vertices, 0.2, options).verdict, Verdict::pass);
  const CertifiedVerdict close = certify_tolerance(surface, pair.sites, map, vertices, 0.1001, options);
  EXPECT_EQ(close.verdict, Verdict::pass);
  EXPECT_TRUE(close.proof);
  const CertifiedVerdict fails = certify_tolerance(surface, pair.sites, map, vertices, 0.05, options);
  EXPECT_EQ(fails.verdict, Verdict::fail);
  EXPECT_EQ(fails.reason, VerdictReason::exceeded);
  const ToleranceShares shares = tolerance_shares(surface, map, 0.05, accuracy);
  EXPECT_NEAR(shares.within + shares.above, 1, 1e-6);
  EXPECT_NEAR(shares.above, 0.375, 0.03) << "the slope between the halves exceeds it on half of its width";
  const ToleranceVerdict check = check_tolerance(surface, map, vertices, bound, accuracy, 0.05);
  EXPECT_NEAR(*check.largest, 0.1, 1e-6);
  EXPECT_NEAR(check.exceeded_area_fraction, shares.above, 1e-9);
  EXPECT_EQ(judge(evidence_of(surface, map, vertices, 1, accuracy), 0.2).verdict, Verdict::not_decided);

  const std::vector<GroupTolerance> table{{.group = "right", .tolerance = 0.001},
                                          {.group = "left", .tolerance = 0.11}};
  EXPECT_EQ(faces_of_groups(pair.names, table)[1].faces.size(), 16u);
  EXPECT_EQ(faces_named(pair.names, "right").faces.front(), 16u);
  EXPECT_EQ(with_kinds(pair.names, table)[0].kind, "group");
  EXPECT_THAT(names_text(pair.names), ::testing::HasSubstr("left"));
  const std::vector<std::uint32_t> some{20, 3};
  EXPECT_EQ(names_of_part(pair.names, some)[0].of_face, (std::vector<std::uint32_t>{1, 0}));
  GroupVerdicts groups =
      certify_groups(surface, pair.sites, map, vertices, pair.names, table, {.accuracy = accuracy});
  ASSERT_EQ(groups.groups.size(), 2u);
  EXPECT_EQ(groups.groups[0].verdict.verdict, Verdict::pass);
  EXPECT_EQ(groups.groups[1].verdict.verdict, Verdict::pass);
  EXPECT_NEAR(*groups.groups[1].highest, 0.1, 1e-6);
  const std::vector<GroupTolerance> strict{{.group = "left", .tolerance = 0.09}};
  const GroupVerdicts failed =
      certify_groups(surface, pair.sites, map, vertices, pair.names, strict, {.accuracy = accuracy});
  EXPECT_EQ(failed.verdict, Verdict::fail);
  const std::vector<GroupVerdicts> parts{failed, failed};
  EXPECT_EQ(combined_groups(parts, strict, false).verdict, Verdict::fail);
  withhold_pass(groups);
  EXPECT_EQ(groups.verdict, Verdict::doubtful);
  std::vector<GroupPoints> points(1);
  points[0].kind = "group";
  points[0].row = table[0];
  points[0].points = 7;
  points[0].faces = 2;
  points[0].evidence = {.lowest = -0.0005, .highest = 0.002};
  points[0].above = 2;
  EXPECT_EQ(judge_groups(points, {}, SignMethod::exact, DistanceKind::closest).verdict, Verdict::fail);
}

// Facing maps: samples bound nothing, each pass is proven.
TEST(SmokeTolerance, PassesOfFacingMapsAreProven) {
  const Mesh plate = weld(grid_block({-1, -1, 0}, {1, 1, 0.1}, 3)).mesh,
             thinner = weld(grid_block({-1, -1, 0}, {1, 1, 0.07}, 2)).mesh;
  const Surface surface(thinner, {.resolution = 40});
  const Sites sites(plate);
  const MapOptions options{.facing = 50};
  const DistanceMap map = compute_map(surface, sites, options);
  const std::vector<float> vertices = distances_at_vertices(thinner, sites, options);
  const CertifyOptions certify{.error_bound = kInfinity, .accuracy = 1e-5};
  const CertifiedVerdict passes = certify_tolerance(surface, sites, map, vertices, 0.031, certify);
  EXPECT_EQ(passes.verdict, Verdict::pass);
  ASSERT_TRUE(passes.proof);
  EXPECT_EQ(passes.proof->proof, Proof::holds);
  EXPECT_EQ(certify_tolerance(surface, sites, map, vertices, 0.029, certify).verdict, Verdict::fail);
}

TEST(SmokeStatistics, OfALinearFieldAreThoseOfAnInterval) {
  const Surface surface(grid_square(2, 0, 4), {.resolution = 97});
  const auto field = [](const Vec3& p) { return p[0]; };  // uniform in [−1, 1]
  const DistanceMap map = map_of(surface, field);
  const DistanceStatistics found = statistics(surface, map);
  EXPECT_NEAR(found.mean, 0, 0.02);
  EXPECT_NEAR(found.rms, 1 / std::sqrt(3.0), 0.02);
  EXPECT_NEAR(found.p05, -0.9, 0.03);
  EXPECT_NEAR(found.p99, 0.98, 0.03);
  EXPECT_NEAR(found.mean_abs, 0.5, 0.02);
  EXPECT_NEAR(found.p50_abs, 0.5, 0.03);
  EXPECT_NEAR(found.negative_area_fraction, 0.5, 0.02);
  const std::optional<Extremes> ends = extremes(surface, map, at_vertices(surface.mesh(), field));
  EXPECT_EQ(ends->max.distance, 1);
  EXPECT_TRUE(ends->max.at_vertex);
  EXPECT_EQ(std::abs(farthest(*ends).distance), 1);
  EXPECT_NEAR(area_fraction_beyond(surface, map, 0.75), 0.25, 0.02);
  const std::vector<double> edges{-0.5, 0, 0.7};
  const std::vector<DistanceBand> bands = distance_bands(surface, map, edges);
  ASSERT_EQ(bands.size(), 4u);
  EXPECT_NEAR(bands[2].area_fraction, 0.35, 0.02);
  const DistanceHistogram histogram = distance_histogram(surface, map, {-0.6, 0.6}, 7);
  for (const double share : histogram.area_fractions) EXPECT_NEAR(share, 0.6 / 7, 0.02);
  EXPECT_NEAR(histogram.below, 0.2, 0.02);
  std::vector<std::uint32_t> halves;
  for (std::size_t f = 0; f < 32; ++f) halves.push_back(f == 9 ? kNone : f < 16 ? 0 : 1);
  const std::vector<PartStatistics> parts =
      part_statistics(surface, map, halves, 2, {.tolerance = Tolerance(0.5)});
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].faces, 15u);
  EXPECT_NEAR(parts[1].distance.mean, 0.5, 0.02);
  EXPECT_NEAR(parts[1].tolerance->within, 0.5, 0.03);
  const Mesh two = joined(grid_square(1, 0, 2), moved(cube(), {9, 0, 0}));
  const std::vector<std::uint32_t> components = face_components(two);
  EXPECT_EQ(components.front(), 0u);
  EXPECT_EQ(components.back(), 1u);
}

TEST(SmokeStatistics, PlacesAreTheRegionsOutOfTolerance) {
  const Surface surface(sphere(2), {.resolution = 128});
  const auto field = [](const Vec3& p) {
    const Vec3 n = normalized(p);
    return n[2] > 0.95 ? 2.0 : n[0] > 0.97 ? -3.0 : n[1] < -0.97 ? std::nan("") : 0.0;
  };
  const DistanceMap map = map_of(surface, field);
  Places places =
      find_places(surface, map, at_vertices(surface.mesh(), field), {.tolerance = Tolerance(0.5)});
  EXPECT_EQ(places.large.count + places.small.count, 3u);
  ASSERT_EQ(places.largest.size(), 3u);
  EXPECT_EQ(places.largest[0].distance, -3);
  EXPECT_EQ(places.largest[1].distance, 2);
  EXPECT_NEAR(places.largest[1].fraction, 0.025, 0.01) << "of a cap of the height 0.05";
  EXPECT_TRUE(std::isnan(places.largest[2].distance));
  std::vector<FaceNames> names{{.kind = "object", .names = {"ball"}, .of_face = {}}};
  names[0].of_face.assign(surface.mesh().triangles.size(), 0);
  name_group(places.largest[0], names);
  EXPECT_EQ(places.largest[0].group, "ball");
  const std::vector<Places> parts{places, places};
  const std::vector<double> areas{1, 3};
  EXPECT_EQ(combined_places(parts, areas)->large.count, 2 * places.large.count);
  const Places without = find_places(surface, map, {}, {.p99_abs = 1.5});
  EXPECT_FALSE(without.by_tolerance);
  EXPECT_EQ(without.largest[0].distance, -3);
  Places ranked = places;
  rank_places({places.largest[1], places.largest[0]}, ranked);
  EXPECT_EQ(ranked.largest[0].distance, -3);
}

TEST(SmokeSummary, HasVerdictNotesAndNumbers) {
  const TwoGroups pair(0.1);
  const Surface surface(pair.o1, {.resolution = 33});
  const DistanceMap map = compute_map(surface, pair.sites);
  const std::vector<float> vertices = distances_at_vertices(pair.o1, pair.sites);
  const Doubt doubt = doubt_of(OtherUnit{.factor = 25.4, .misfit = 0.001, .misfit_as_given = 0.5});
  EXPECT_EQ(doubt.reason, DoubtReason::other_unit);
  EXPECT_FALSE(doubt_of(Coverage{.value = 0.9}, 0.8));
  EXPECT_EQ(doubt_of(Coverage{.value = 0.3}, 0.8)->reason, DoubtReason::low_coverage);
  EXPECT_STREQ(name_of(DoubtReason::mirrored), "mirrored");
  Summary summary = summarize(surface, pair.sites, map, vertices,
                              {.units = "mm",
                               .accuracy = engine_accuracy(engines()[0], pair.o1, pair.sites.mesh()),
                               .tolerance = Tolerance(0.2),
                               .names = pair.names,
                               .coverage = coverage(pair.sites.mesh(), Sites(pair.o1), 0.2),
                               .doubts = {doubt}});
  EXPECT_EQ(summary.tolerance->verdict, Verdict::doubtful);
  EXPECT_NEAR(summary.distance.max, 0.1, 1e-6);
  EXPECT_NEAR(summary.extremes->max.distance, 0.1, 1e-6);
  EXPECT_LE(*summary.hausdorff.lower, 0.1);
  EXPECT_GE(*summary.hausdorff.upper, 0.1 - 1e-9);
  EXPECT_EQ(summary.distribution->parts.size(), 2u);
  EXPECT_FALSE(verdict_text(summary).empty());
  constexpr double kNone = std::numeric_limits<double>::infinity();
  EXPECT_EQ(limits_text(0.2, "mm", true), "±0.2 mm");
  EXPECT_EQ(limits_text(0.2, "mm", false), "0.2 mm");
  EXPECT_EQ(limits_text({-kNone, 0.2}, "", true), "at most 0.2");
  EXPECT_EQ(limits_text({0.123456, kNone}, "", true), "at least 0.12346");
  EXPECT_EQ(limits_text({-0.1, 0.2}, "mm", true), "-0.1 to 0.2 mm");
  Summary accepted = summary;
  withhold_pass(accepted, true);
  EXPECT_STREQ(name_of(summary.tolerance->verdict), "DOUBTFUL");
  EXPECT_STREQ(name_of(VerdictReason::all_within), "all within");
  EXPECT_STREQ(name_of(Colormap::viridis), "viridis");
  EXPECT_STREQ(name_of(SignMethod::side), "side");
  EXPECT_STREQ(name_of(DistanceKind::along), "along");
  EXPECT_STREQ(name_of(AtlasKind::uv), "uv");
  MapReport report{
      .on = {.file = "o1.ply", .info = inspect(pair.o1)}, .to = {.file = "o2.ply"}, .engine = "cpu"};
  const nlohmann::json json = nlohmann::json::parse(report_json(report, surface, summary));
  EXPECT_EQ(json["tolerance"]["verdict"], "DOUBTFUL");
  EXPECT_EQ(json["distance"]["max"], summary.distance.max);
  EXPECT_EQ(nlohmann::json::parse(summary_json(summary))["units"], "mm");
  EXPECT_EQ(nlohmann::json::parse(mesh_json(report.on))["triangles"], 32);
  Tessellation tessellation;
  tessellation.format = "STEP";
  tessellation.largest_deviation = 0.01;
  EXPECT_EQ(nlohmann::json::parse(tessellation_json(tessellation))["format"], "STEP");
  EXPECT_THAT(note_on(tessellation, "a.step"), ::testing::HasSubstr("a.step"));

  DistanceStatistics distances;
  distances.min = 0;
  distances.max = 0.9;
  distances.p99_abs = 0.8;
  distances.p01 = 0;
  distances.p99 = 0.8;
  const ColorRange range = color_range({}, distances);
  EXPECT_EQ(range.colormap, Colormap::viridis);
  EXPECT_GE(range.range[1], 0.8);
  EXPECT_EQ(widest(range, {.range = {-2, 0.5}}).range[0], -2);
  EXPECT_EQ(default_bands(Tolerance(0.5), true), (std::vector<double>{-1, -0.5, -0.25, 0.25, 0.5, 1}));
  const Box small{{0, 0, 0}, {1, 1, 1}}, large{{0, 0, 0}, {25.4, 25.4, 25.4}},
      far{{1e4, 0, 0}, {1e4 + 1, 1, 1}};
  EXPECT_TRUE(note_on_sizes(small, large));
  EXPECT_TRUE(note_on_places(small, far));
  EXPECT_EQ(notes_on(small, small).size(), 0u);
  EXPECT_TRUE(note_on_walls(Sites(box({-3, -3, 0}, {3, 3, 0.1})), Tolerance(0.2), "mm"));
  const std::vector<FaceNames> of_block{
      {.kind = "group", .names = {"all"}, .of_face = std::vector<std::uint32_t>(12)}};
  const std::vector<GroupTolerance> wide{{.group = "all", .tolerance = 0.2}};
  EXPECT_TRUE(note_on_walls(Sites(box({-3, -3, 0}, {3, 3, 0.1})), std::nullopt, of_block, wide, "mm"));
  EXPECT_EQ(*metres_per("in"), 0.0254);
  EXPECT_EQ(metres_per("\u00b5m"), metres_per("um"));
  EXPECT_EQ(metres_per("\u03bcm"), metres_per("um"));
}

// Of the faces of the input near a cut, and points of the result that are far from it: by the Hausdorff
// distance.
TEST(SmokeSimplify, CertificatesAreWithinIndependentBounds) {
  const Mesh mesh = torus(24, 16);
  Simplifier simplifier(mesh);
  const Simplified fine = simplifier.to_deviation(0.05);
  const Simplified coarse = simplifier.to_triangles(100, {.from = &fine, .single_precision = true});
  EXPECT_LT(fine.mesh.triangles.size(), mesh.triangles.size());
  EXPECT_LE(coarse.mesh.triangles.size(), fine.mesh.triangles.size());
  EXPECT_LE(fine.deviation.upper, 0.05);
  for (const Simplified* result : {&fine, &coarse}) {
    const SymmetricHausdorff truth =
        symmetric_hausdorff(Sites(result->mesh), Sites(mesh), {.precision = 1e-3});
    EXPECT_LE(truth.larger.distance.lower, result->deviation.upper + 1e-6);
    EXPECT_GE(truth.larger.distance.upper, result->deviation.lower - 1e-6);
    EXPECT_EQ(result->mesh.corner_uvs.size(), result->mesh.triangles.size());
  }
  EXPECT_GE(simplifier.report().candidates, 2u);
  Simplifier of_open(first_faces(sphere(2), 301));
  const Simplified open = of_open.to_deviation(0.1);
  EXPECT_LT(open.mesh.triangles.size(), 301u);
  EXPECT_LE(open.deviation.upper, 0.1);
  EXPECT_TRUE(Simplifier(single_triangle()).to_triangles(1).mesh.triangles.size() == 1);
}

}  // namespace
}  // namespace sdm::test

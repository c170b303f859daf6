// Verdicts on distances to the faces that face the same way: of all points, not only of samples.
#include <gtest/gtest.h>
#include <sdm/hausdorff.h>
#include <sdm/map.h>
#include <sdm/summary.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "map/terrain.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr double kAccuracy = 1e-5;

/// A flat scan with a folded face, which is so small in its texture that no texel is on it; its corners are
/// those of a face that is not folded.
Mesh folded() {
  Mesh mesh = terrain(8, [](double, double) { return 0.0; });
  constexpr double kSize = 1e-4;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& [x, y] : {std::pair(3.0, 3.0), {3.0 + kSize, 3.0}, {3.0, 3.0 + kSize}})
    mesh.positions.push_back({x, y, 0});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 1});
  for (const Triangle& t : mesh.triangles) {
    auto& corners = mesh.corner_uvs.emplace_back();
    for (int k = 0; k < 3; ++k) corners[k] = {mesh.positions[t[k]][0] / 20, mesh.positions[t[k]][1] / 20};
  }
  return mesh;
}

struct Judged {
  Mesh scan;
  Sites sites;
  MapOptions options;
  Surface surface{scan,
                  {.kind = scan.corner_uvs.empty() ? AtlasKind::charts : AtlasKind::uv, .resolution = 64}};
  DistanceMap map = compute_map(surface, sites, options);
  std::vector<float> at_vertices = distances_at_vertices(scan, sites, options);

  Judged(Mesh o1, const Mesh& o2, const MapOptions& chosen = {.facing = 90})
      : scan(std::move(o1)), sites(o2), options(chosen) {}

  [[nodiscard]] CertifiedVerdict verdict(const Tolerance& tolerance) const {
    return certify_tolerance(surface, sites, map, at_vertices, tolerance,
                             {.error_bound = 0.1, .accuracy = kAccuracy});
  }
  [[nodiscard]] GroupVerdicts verdicts(const FaceNames& names, std::span<const GroupTolerance> table) const {
    return certify_groups(surface, sites, map, at_vertices, {&names, 1}, table, {.accuracy = kAccuracy});
  }
};

TEST(FacingVerdicts, APassIsProven) {
  for (const double thickness : {0.5, 1.0, 3.0}) {
    SCOPED_TRACE(thickness);
    const Judged dent(dented(24, 0.79), thick_plate(thickness));
    const CertifiedVerdict passes = dent.verdict(0.8), fails = dent.verdict(0.78);
    EXPECT_EQ(passes.verdict, Verdict::pass);
    EXPECT_TRUE(passes.certified);
    ASSERT_TRUE(passes.proof);
    EXPECT_EQ(passes.proof->proof, Proof::holds);
    // What it claims: the scan is the graph of a function, of which the upper side is the closest that faces
    // up.
    for (const Vec3& p : dent.scan.positions) EXPECT_LE(std::abs(p[2]), 0.8);
    EXPECT_EQ(fails.verdict, Verdict::fail);
    EXPECT_TRUE(fails.certified);
    const CertifiedVerdict limit = dent.verdict(0.79 - 0.5 * kAccuracy);
    EXPECT_EQ(limit.verdict, Verdict::not_decided);
    EXPECT_EQ(limit.reason, VerdictReason::within_rounding);
    EXPECT_LE(limit.proof->undecided_by.value(), kAccuracy);
  }
}

TEST(FacingVerdicts, WhatDependsOnSignsIsAnEstimate) {
  const Judged dent(dented(24, 0.79), thick_plate(1));
  const CertifiedVerdict verdict = dent.verdict({-0.8, 0.1});
  EXPECT_EQ(verdict.verdict, Verdict::pass);
  EXPECT_EQ(verdict.reason, VerdictReason::all_within);
  EXPECT_FALSE(verdict.certified);
  ASSERT_TRUE(verdict.proof);
  EXPECT_TRUE(verdict.proof->depends_on_signs);
  EXPECT_TRUE(dent.verdict({-2, 0.8}).certified) << "with either sign";
}

// The vertices have the least distance of the faces around them, and no texel is on the folded face: it has a
// sample of its own.
TEST(FacingVerdicts, FaceWithoutATexelFails) {
  const Judged fold(folded(), thick_plate(2));
  const auto last = static_cast<std::uint32_t>(fold.scan.triangles.size() - 1);
  ASSERT_EQ(std::ranges::count(fold.surface.texel_faces(), last), 0);
  const CertifiedVerdict verdict = fold.verdict(0.5);
  EXPECT_EQ(verdict.verdict, Verdict::fail);
  EXPECT_EQ(verdict.reason, VerdictReason::exceeded);
  EXPECT_TRUE(verdict.certified);
  EXPECT_NEAR(verdict.largest.value(), 2, 1e-6) << "to the lower side";
  EXPECT_GT(verdict.exceeded_area_fraction, 0);
  EXPECT_TRUE(fold.verdict(2.1).certified);

  // An open O2 has no face that faces down.
  const Judged open(folded(), square(60, 0));
  const CertifiedVerdict unmatched = open.verdict(0.5);
  EXPECT_EQ(unmatched.verdict, Verdict::fail);
  EXPECT_EQ(unmatched.reason, VerdictReason::without_match);
  EXPECT_TRUE(unmatched.certified);
  EXPECT_EQ(open.map.without_match, 1U);
  const Summary summary = summarize(open.surface, open.sites, open.map, open.at_vertices,
                                    {.accuracy = kAccuracy, .tolerance = 0.5});
  EXPECT_EQ(verdict_text(summary), "no face of the reference faces as a point does");
}

/// A scan of a plate of 20 × 20 × 1, of which noise moved a vertex over the edge between two others, so that
/// the sliver of the three faces down.
Mesh turned_over(double noise) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0},
                    {20, 0, 0},
                    {20, 20, 0},
                    {0, 20, 0},
                    {0, 0, 1},
                    {20, 0, 1},
                    {20, 20, 1},
                    {0, 20, 1},
                    {5, 10, 1},
                    {15, 10, 1},
                    {10, 10 - noise, 1 + noise}};
  mesh.triangles = {{4, 5, 9},  {4, 9, 8},  {4, 8, 7}, {5, 6, 9}, {7, 8, 10}, {7, 10, 6},
                    {6, 10, 9}, {8, 9, 10}, {0, 2, 1}, {0, 3, 2}, {0, 1, 5},  {0, 5, 4},
                    {1, 2, 6},  {1, 6, 5},  {2, 3, 7}, {2, 7, 6}, {3, 0, 4},  {3, 4, 7}};
  return mesh;
}

Mesh plate(double thickness) {
  Mesh mesh = cube(1);
  for (Vec3& p : mesh.positions) p = {10 + 10 * p[0], 10 + 10 * p[1], thickness * (p[2] + 1) / 2};
  return mesh;
}

TEST(FacingVerdicts, ASliverThatNoiseTurnedOverCountsAsItsSurroundings) {
  const Judged scan(turned_over(0.01), plate(1));
  const CertifiedVerdict passes = scan.verdict(0.0101), fails = scan.verdict(0.0099);
  EXPECT_EQ(passes.verdict, Verdict::pass);
  EXPECT_TRUE(passes.certified);
  EXPECT_EQ(fails.verdict, Verdict::fail);
  for (const std::uint32_t texel : scan.surface.sample_texels())
    EXPECT_LE(std::abs(scan.map.distance[texel]), 0.0100001);
  const HausdorffDistance largest = one_sided_hausdorff(scan.scan, scan.sites, {.facing = 90});
  EXPECT_NEAR(largest.distance.lower, 0.01, 1e-6);
  EXPECT_LE(largest.distance.upper, 0.0101);
  const Summary summary = summarize(scan.surface, scan.sites, scan.map, scan.at_vertices,
                                    {.units = "mm", .accuracy = kAccuracy, .tolerance = 0.0101});
  EXPECT_EQ(summary.notes, std::vector<std::string>{
                               "the direction of 1 face lower than 0.028 mm, with 0.008 % of the area, is "
                               "ignored: so small, it is noise, and that of its surroundings counts"});
  // A face that is larger than noise has the direction that it has.
  const Judged large(turned_over(0.5), plate(1));
  EXPECT_EQ(large.verdict(0.6).verdict, Verdict::fail);
  EXPECT_FALSE(note_on_directions(large.scan, 90, ""));
}

// Rims, tips and bodies that are as small have no surroundings with another direction.
TEST(FacingVerdicts, SmallFeaturesKeepTheirDirections) {
  EXPECT_FALSE(note_on_directions(plate(0.01), 90, ""));
  EXPECT_FALSE(note_on_directions(plate(0.01), 30, ""));
  Mesh crumb = tetrahedron();
  for (Vec3& p : crumb.positions) p = 0.001 * p;
  EXPECT_FALSE(note_on_directions(joined(cube(10), crumb), 90, ""));
  EXPECT_FALSE(note_on_directions(needles(1e-4), 90, ""));
}

// A search that ended without a point out of the limits is no matter of rounding.
TEST(Verdicts, SayWhyAProofDecidedNothing) {
  ToleranceProof proof{.proof = Proof::undecided, .undecided_by = 0.035};
  EXPECT_EQ(judge(Judgement{}, proof).reason, VerdictReason::between_samples);
  proof.witness.emplace();
  EXPECT_EQ(judge(Judgement{}, proof).reason, VerdictReason::within_rounding);
  proof.depends_on_signs = true;
  EXPECT_EQ(judge(Judgement{}, proof).reason, VerdictReason::estimated_signs);
}

TEST(FacingVerdicts, GroupsAreProven) {
  const Judged dent(dented(24, 0.79), thick_plate(1));
  FaceNames names{.kind = "group", .names = {"rim", "dent"}, .of_face = {}};
  for (const Triangle& t : dent.scan.triangles)
    names.of_face.push_back(std::ranges::any_of(t, [&](auto v) { return dent.scan.positions[v][2] < 0; }));
  std::vector<std::uint32_t> of_dent;
  for (std::uint32_t f = 0; f < names.of_face.size(); ++f)
    if (names.of_face[f] == 1) of_dent.push_back(f);
  const std::vector<GroupTolerance> table{{"rim", 0.01}, {"dent", 0.8}};
  const GroupVerdicts found = dent.verdicts(names, table);
  EXPECT_EQ(found.verdict, Verdict::pass);
  for (const GroupVerdict& group : found.groups) {
    EXPECT_EQ(group.verdict.verdict, Verdict::pass) << group.group;
    EXPECT_TRUE(group.verdict.certified);
    EXPECT_EQ(group.verdict.proof->proof, Proof::holds);
  }
  const std::vector<GroupTolerance> tight{{"rim", 0.01}, {"dent", 0.6}};
  EXPECT_EQ(dent.verdicts(names, tight).groups[1].verdict.verdict, Verdict::fail);
  const ToleranceProof alone = prove_tolerance(dent.scan, dent.sites, 0.79 - 0.5 * kAccuracy,
                                               {.accuracy = kAccuracy, .facing = 90, .faces = of_dent}),
                       grouped =
                           dent.verdicts(names, std::vector<GroupTolerance>{{"dent", 0.79 - 0.5 * kAccuracy}})
                               .groups[0]
                               .verdict.proof.value();
  EXPECT_EQ(alone.proof, Proof::undecided);
  EXPECT_EQ(grouped.undecided_by, alone.undecided_by);
  EXPECT_EQ(grouped.witness->face, alone.witness->face);
}

// Of several maps, a pass is proven if that of each is.
TEST(FacingVerdicts, SeveralMapsAreProvenTogether) {
  const Judged dent(dented(24, 0.79), thick_plate(1)), flat(dented(24, 0), thick_plate(1));
  const auto together = [&](const Tolerance& tolerance) {
    CombinedSummary all;
    for (const Judged* part : {&flat, &dent})
      all.add(part->surface, part->map,
              summarize(part->surface, part->sites, part->map, part->at_vertices,
                        {.accuracy = kAccuracy, .tolerance = tolerance}));
    return all.summary();
  };
  EXPECT_TRUE(together(0.8).tolerance->certified);
  EXPECT_EQ(verdict_text(together(0.8)), "every point of the surface is within ±0.8");
  EXPECT_TRUE(flat.verdict({-0.8, 0.1}).certified);
  EXPECT_FALSE(together({-0.8, 0.1}).tolerance->certified);
  EXPECT_EQ(verdict_text(together({-0.8, 0.1})),
            "every measured point of the surface is within -0.8 to 0.1, an estimate for those between them");
}

}  // namespace
}  // namespace sdm::test

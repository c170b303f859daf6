// Verdicts of tolerances, against distances that are known: from one square to another, parallel one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/summary.h>
#include <sdm/tolerance.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "support/shapes.h"

namespace sdm::test {
namespace {

/// The lower square's map of the distances to a square that is 1 above it.
struct ToleranceTest : ::testing::Test {
  Surface surface{square(1, 0), {.resolution = 32}};
  Sites sites{square(2, 1)};
  DistanceMap map = compute_map(surface, sites);
  std::vector<float> at_vertices = distances_at_vertices(surface.mesh(), sites);
};

TEST_F(ToleranceTest, IsCertifiedWithTheErrorBoundToSpare) {
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0.25, 0, 1.25);
  EXPECT_EQ(verdict.largest, 1);
  EXPECT_EQ(verdict.exceeded_area_fraction, 0);
  EXPECT_TRUE(verdict.within);
  EXPECT_TRUE(verdict.certified);
}

TEST_F(ToleranceTest, IsNotCertifiedIfTheErrorBoundReachesBeyond) {
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0.26, 0, 1.25);
  EXPECT_TRUE(verdict.within);
  EXPECT_FALSE(verdict.certified);
}

TEST_F(ToleranceTest, IsCertainlyExceeded) {
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0.25, 0, 0.99);
  EXPECT_FALSE(verdict.within);
  EXPECT_TRUE(verdict.certified);
  EXPECT_EQ(verdict.exceeded_area_fraction, 1);
}

TEST_F(ToleranceTest, IsExceededByASingleVertexOrSample) {
  std::vector<float> one_vertex = at_vertices;
  one_vertex[2] = 3;
  EXPECT_EQ(check_tolerance(surface, map, one_vertex, 0, 0, 2).largest, 3);
  EXPECT_FALSE(check_tolerance(surface, map, one_vertex, 0, 0, 2).within);
  map.distance[surface.sample_texels()[5]] = 3;
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0, 0, 2);
  EXPECT_FALSE(verdict.within);
  EXPECT_GT(verdict.exceeded_area_fraction, 0);
  EXPECT_LT(verdict.exceeded_area_fraction, 0.1);
}

TEST_F(ToleranceTest, OfOneSideOnlyExceedsOnThatSide) {
  const auto verdict = [&](double lo, double hi, double bound = 0.25, double accuracy = 0) {
    return check_tolerance(surface, map, at_vertices, bound, accuracy, Tolerance(lo, hi));
  };
  // Unsigned distances of 1.
  EXPECT_EQ(verdict(0.75, 1.25).verdict, Verdict::pass);
  EXPECT_EQ(verdict(0.8, 1.25).verdict, Verdict::not_decided) << "the least distance may be 0.75";
  EXPECT_EQ(verdict(0.75, 1.2).verdict, Verdict::not_decided);
  EXPECT_EQ(verdict(1.01, 2).verdict, Verdict::fail);
  EXPECT_EQ(verdict(1.01, 2).shares.below, 1);
  EXPECT_EQ(verdict(0, 0.99).verdict, Verdict::fail);
  EXPECT_EQ(verdict(0, 0.99).shares.above, 1);
  EXPECT_EQ(verdict(1.01, 2, 0, 0.02).verdict, Verdict::not_decided) << "rounding";
  EXPECT_THROW((void)verdict(-1, 2), Error);
  map.sign.method = SignMethod::exact;
  EXPECT_EQ(verdict(-1, 2).verdict, Verdict::pass);
  // Estimated signs may be wrong between the samples.
  map.sign.method = SignMethod::winding;
  EXPECT_EQ(verdict(-1, 2).verdict, Verdict::not_decided);
  EXPECT_EQ(verdict(-1.25, 2).verdict, Verdict::pass);
  EXPECT_EQ(verdict(-2, 0.5).verdict, Verdict::fail);
  EXPECT_FALSE(verdict(-2, 0.5).certified) << "inside, it would be within";
  EXPECT_TRUE(verdict(-0.5, 0.5).certified);
}

// An error bound of half of the margin decides.
TEST_F(ToleranceTest, NamesTheErrorBoundThatWouldDecide) {
  const auto verdict = [&](double bound, double accuracy, double tolerance) {
    return check_tolerance(surface, map, at_vertices, bound, accuracy, tolerance);
  };
  const double bound = verdict(1, 0.01, 1.25).deciding_bound.value();
  EXPECT_NEAR(bound, (1.25 - 1 - 0.01) / 2, 1e-12);
  EXPECT_EQ(verdict(bound, 0.01, 1.25).verdict, Verdict::pass);
  EXPECT_EQ(verdict(1, 0.01, 1.005).verdict, Verdict::not_decided);
  EXPECT_EQ(verdict(1, 0.01, 1.005).deciding_bound, std::nullopt) << "within rounding of the limit";
}

// At distances that rounding does not tell from zero, the sign is not certain either.
TEST_F(ToleranceTest, IsNotExceededByTheSignOfRounding) {
  map.sign.method = SignMethod::exact;
  for (float& d : map.distance) d = std::isnan(d) ? d : -1e-3f;
  for (float& d : at_vertices) d = -1e-3f;
  EXPECT_TRUE(check_tolerance(surface, map, at_vertices, 0, 1.1e-3, Tolerance(1.5e-3, 1)).within);
  EXPECT_FALSE(check_tolerance(surface, map, at_vertices, 0, 1.1e-3, Tolerance(2.5e-3, 1)).within);
  EXPECT_FALSE(check_tolerance(surface, map, at_vertices, 0, 1e-5, Tolerance(0, 1)).within);
}

TEST_F(ToleranceTest, IsExceededWhereThereIsNoValue) {
  std::vector<float> unknown = at_vertices;
  unknown[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(check_tolerance(surface, map, unknown, 0, 0, 2).within);
  const MapOptions near{.max_distance = 0.5};
  map = compute_map(surface, sites, near);
  const ToleranceVerdict verdict = check_tolerance(surface, map, at_vertices, 0, 0, 2);
  EXPECT_FALSE(verdict.within);
  EXPECT_EQ(verdict.margin, std::nullopt);
  EXPECT_EQ(verdict.largest, std::nullopt);
}

TEST(Judge, OfNothingMeasuredHasNoNumbers) {
  const Judgement judgement = judge({}, 1);
  EXPECT_EQ(judgement.verdict, Verdict::not_decided);
  EXPECT_EQ(judgement.reason, VerdictReason::nothing_measured);
  EXPECT_EQ(judgement.margin, std::nullopt);
  EXPECT_EQ(judgement.deciding_bound, std::nullopt);
}

TEST_F(ToleranceTest, RejectsDistancesOfOtherVertices) {
  at_vertices.pop_back();
  EXPECT_THROW(static_cast<void>(check_tolerance(surface, map, at_vertices, 0, 0, 2)), Error);
}

// The guard band is on both sides of both limits.
TEST(Judge, ByISO14253) {
  for (const double u : {0.0, 0.1, 0.3})
    for (const auto& [lowest, highest] : {std::pair(-0.5, 0.5),
                                          {-0.95, 0.2},
                                          {-0.2, 0.95},
                                          {-1.05, 0.0},
                                          {0.0, 1.05},
                                          {-0.65, 0.65},
                                          {-1.5, 0.0},
                                          {0.0, 1.25},
                                          {-2.0, 2.0}}) {
      const Judgement j =
          judge({.lowest = lowest, .highest = highest, .guard = u, .uncertainty = u}, Tolerance(-1, 1));
      const Verdict expected = lowest >= -1 + u && highest <= 1 - u ? Verdict::pass
                               : lowest < -1 - u || highest > 1 + u ? Verdict::fail
                                                                    : Verdict::not_decided;
      EXPECT_EQ(j.verdict, expected) << lowest << ' ' << highest << " ± " << u;
      EXPECT_EQ(j.decision_rule, u > 0 ? DecisionRule::iso_14253_1 : DecisionRule::simple_acceptance);
      EXPECT_EQ(j.reason == VerdictReason::guard_band, expected == Verdict::not_decided);
    }
}

// Each verdict says what follows from it; one that another measurement may decide, which options that takes.
TEST(NextSteps, FollowFromEachReason) {
  Summary summary{.evidence = {.guard = 0.3, .uncertainty = 0.1}};
  EXPECT_EQ(next_steps(summary).part, "");
  std::set<std::string> parts;
  for (std::size_t r = 0; r < kWords<VerdictReason>.size(); ++r) {
    CertifiedVerdict& verdict = summary.tolerance.emplace();
    verdict.reason = static_cast<VerdictReason>(r);
    verdict.verdict =
        verdict.reason == VerdictReason::all_within || verdict.reason == VerdictReason::small_places
            ? Verdict::pass
        : verdict.reason <= VerdictReason::without_match ? Verdict::fail
        : verdict.reason == VerdictReason::in_doubt      ? Verdict::doubtful
                                                         : Verdict::not_decided;
    if (verdict.reason == VerdictReason::small_places) verdict.by_places.emplace();
    // Thin walls end as one of the others, and an accuracy that is unknown says nothing of the part.
    if (verdict.reason == VerdictReason::thin_walls || verdict.reason == VerdictReason::unknown_accuracy)
      continue;
    const NextSteps next = next_steps(summary);
    EXPECT_TRUE(next.part.ends_with(".")) << name_of(verdict.reason);
    EXPECT_TRUE(parts.insert(next.part).second) << next.part;
  }
  summary.tolerance->verdict = Verdict::not_decided;
  summary.tolerance->reason = VerdictReason::guard_band;
  EXPECT_THAT(next_steps(summary).measurement,
              ::testing::AllOf(::testing::HasSubstr("--uncertainty"), ::testing::HasSubstr("--deflection")));
  summary.evidence.guard = 0.1;
  EXPECT_THAT(next_steps(summary).measurement, ::testing::Not(::testing::HasSubstr("--deflection")));
}

TEST(EngineAccuracy, IsRelativeToTheDiagonalOfBothMeshes) {
  for (const EngineInfo& engine : engines())
    EXPECT_DOUBLE_EQ(engine_accuracy(engine, square(1, 0), square(2, 1)),
                     engine.relative_error * std::sqrt(4 + 4 + 1));
}

}  // namespace
}  // namespace sdm::test

// Verdicts on mechanical and free-form parts, good and with a defect, at a resolution at which maps alone do
// not decide. The truth is computed by CGAL.
#include <gtest/gtest.h>
#include <sdm/map.h>
#include <sdm/sampling_bound.h>
#include <sdm/verdict.h>

#include "support/judged_parts.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

CertifiedVerdict verdict_of(const Mesh& o1, const Sites& o2, const Tolerance& tolerance) {
  const Surface surface(o1, {.resolution = 512});
  const DistanceMap map = compute_map(surface, o2);
  return certify_tolerance(surface, o2, map, distances_at_vertices(o1, o2), tolerance,
                           {.error_bound = covering_radius(surface),
                            .accuracy = engine_accuracy(engines().front(), o1, o2.mesh())});
}

TEST(PartVerdicts, GoodPartsPassAndDefectsFail) {
  constexpr double kLimit = 0.01;
  int proofs = 0, passed = 0, failed = 0;
  for (const auto& [name, part] : judged_parts()) {
    SCOPED_TRACE(name);
    const Sites sites(part);
    for (const Mesh& good : {part, remeshed(part), moved(part, {0.0099, 0, 0})}) {
      const CertifiedVerdict verdict = verdict_of(good, sites, kLimit);
      EXPECT_EQ(verdict.verdict, Verdict::pass) << static_cast<int>(verdict.reason);
      EXPECT_TRUE(verdict.certified);
      passed += verdict.verdict == Verdict::pass;
      proofs += verdict.proof.has_value();
    }
    const CertifiedVerdict verdict = verdict_of(with_defect(part, kLimit), sites, kLimit);
    EXPECT_EQ(verdict.verdict, Verdict::fail);
    EXPECT_TRUE(verdict.certified);
    failed += verdict.verdict == Verdict::fail;
  }
  EXPECT_EQ(passed, 60);
  EXPECT_EQ(failed, 20);
  EXPECT_GT(proofs, 20) << "maps alone do not decide";
}

}  // namespace
}  // namespace sdm::test

// Verdicts on mechanical and free-form parts, good and with a defect, at a resolution at which maps alone do
// not decide. The truth is computed by CGAL.
#include <gtest/gtest.h>
#include <sdm/certified_verdict.h>
#include <sdm/sampling_bound.h>
#include <sdm/vertex_distances.h>

#include <cmath>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// Of size 1, so that lengths are relative.
std::vector<std::pair<std::string, Mesh>> parts() {
  std::vector<std::pair<std::string, Mesh>> result;
  for (const char* name : {"fandisk.off", "cow.off", "elephant.off", "anchor.off", "pinion.off", "rotor.off",
                           "joint.off", "couplingdown.off", "dragknob.off", "spool.off", "pipe.off",
                           "knot1.off", "bones.off", "star.off", "cross.off", "beam.off"})
    result.emplace_back(name, load(name, "fit"));
  result.emplace_back("ring", ring(32, 0.5));
  result.emplace_back("cube", cube(0.5));
  result.emplace_back("sphere", placed(sphere(3), "scale:0.5"));
  result.emplace_back("two cubes", joined(cube(0.3), moved(cube(0.2), {0.8, 0, 0})));
  return result;
}

/// Each face in quarters: the same surface by other vertices, up to rounding.
Mesh remeshed(const Mesh& mesh) {
  Mesh result;
  result.positions = mesh.positions;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      result.positions.push_back(0.5 * (mesh.positions[std::min(i, j)] + mesh.positions[std::max(i, j)]));
      return static_cast<std::uint32_t>(result.positions.size() - 1);
    };
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t :
         {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}})
      result.triangles.push_back(t);
  }
  return result;
}

CertifiedVerdict verdict_of(const Mesh& o1, const Sites& o2, const Tolerance& tolerance) {
  const Surface surface(o1, {.resolution = 512});
  const DistanceMap map = compute_map(surface, o2);
  return certify_tolerance(surface, o2, map, distances_at_vertices(o1, o2), tolerance,
                           {.error_bound = covering_radius(surface),
                            .accuracy = engine_accuracy(engines().front(), o1, o2.mesh())});
}

/// The part with a vertex that is farther than 1.2 times the limit from it, as CGAL finds: the first that is,
/// if moved outwards by 1.25 times the limit.
Mesh with_defect(const Mesh& part, double limit) {
  const oracle::CgalDistance distance(part);
  std::vector<Vec3> normals(part.positions.size());
  for (const Triangle& t : part.triangles) {
    const Vec3 n =
        cross(part.positions[t[1]] - part.positions[t[0]], part.positions[t[2]] - part.positions[t[0]]);
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    for (const double times : {1.25, -1.25, 2.0}) {
      const Vec3 moved = part.positions[v] + times * limit * normalized(normals[v]);
      if (const double d = distance(moved); d < 1.2 * limit || d > 1.6 * limit) continue;
      Mesh defect = part;
      defect.positions[v] = moved;
      return defect;
    }
  ADD_FAILURE() << "no vertex can be moved away";
  return part;
}

TEST(PartVerdicts, GoodPartsPassAndDefectsFail) {
  constexpr double kLimit = 0.01;
  int proofs = 0, passed = 0, failed = 0;
  for (const auto& [name, part] : parts()) {
    SCOPED_TRACE(name);
    const Sites sites(part);
    for (const Mesh& good : {part, remeshed(part), moved(part, {0.0099, 0, 0})}) {
      const CertifiedVerdict verdict = verdict_of(good, sites, kLimit);
      EXPECT_EQ(verdict.verdict, Verdict::pass) << static_cast<int>(verdict.reason);
      EXPECT_TRUE(verdict.certified);
      passed += verdict.verdict == Verdict::pass, proofs += verdict.proof.has_value();
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

// Proofs of tolerances, against dense samples whose signed distances CGAL computes.
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "support/meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// The distances to a mesh by CGAL, negative inside of it if it is closed.
class SignedOracle {
 public:
  SignedOracle(const Mesh& mesh, bool is_signed) : distance_(mesh) {
    if (is_signed) inside_ = std::make_unique<oracle::CgalInside>(mesh);
  }
  double operator()(const Vec3& p) const {
    const double d = distance_(p);
    return inside_ && d > 0 && (*inside_)(p) ? -d : d;
  }

 private:
  oracle::CgalDistance distance_;
  std::unique_ptr<oracle::CgalInside> inside_;
};

/// The extreme distances of samples, of which every point of the mesh has one within `spacing`.
struct Extent {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest, spacing = 0;
};

Extent extent_of(const Mesh& a, const SignedOracle& distance, int n) {
  Extent extent;
  for (const Triangle& t : a.triangles) {
    const Vec3 &p = a.positions[t[0]], u = a.positions[t[1]] - p, v = a.positions[t[2]] - p;
    extent.spacing = std::max({extent.spacing, norm(u) / n, norm(v) / n, norm(v - u) / n});
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const double d = distance(p + (1.0 * i / n) * u + (1.0 * j / n) * v);
        extent.lowest = std::min(extent.lowest, d);
        extent.highest = std::max(extent.highest, d);
      }
  }
  return extent;
}

/// Checks an answer against the samples, and the witness against CGAL.
void check(const ToleranceProof& found, const Tolerance& tolerance, const Extent& extent, const Mesh& a,
           const SignedOracle& distance, bool is_signed) {
  constexpr double kRounding = 1e-9;
  const double lo = is_signed || tolerance.lower > 0 ? tolerance.lower : -1e300;
  const bool surely_inside =
      extent.lowest - extent.spacing > lo && extent.highest + extent.spacing < tolerance.upper;
  const bool surely_outside = extent.lowest < lo - kRounding || extent.highest > tolerance.upper + kRounding;
  ASSERT_NE(found.proof, Proof::undecided)
      << tolerance.lower << ":" << tolerance.upper << " by " << found.undecided_by.value_or(-1);
  if (surely_inside) {
    EXPECT_EQ(found.proof, Proof::holds);
  }
  if (surely_outside) {
    EXPECT_EQ(found.proof, Proof::fails);
  }
  if (found.proof == Proof::holds) return;
  ASSERT_TRUE(found.witness);
  const double d = found.witness->distance;
  EXPECT_TRUE(d < lo || d > tolerance.upper) << d;
  EXPECT_EQ(found.at_lower, d < lo);
  EXPECT_NEAR(distance(found.witness->point), d, kRounding);
  EXPECT_NEAR(norm(found.witness->closest - found.witness->point), std::abs(d), kRounding);
  const Triangle& t = a.triangles[found.witness->face];
  EXPECT_LT(oracle::distance(found.witness->point, a.positions[t[0]], a.positions[t[1]], a.positions[t[2]]),
            kRounding);
}

/// Limits below, at, and above the extremes, in all combinations.
void check_all(const Mesh& a, const Mesh& b, int n) {
  const Sites sites(b);
  const bool is_signed = sites.closed() && sites.orientable();
  const SignedOracle distance(b, is_signed);
  const Extent extent = extent_of(a, distance, n);
  const double step = 2.1 * extent.spacing;
  for (const double below : {-step, -0.01 * step, 0.01 * step, step})
    for (const double above : {-step, -0.01 * step, 0.01 * step, step}) {
      const Tolerance tolerance(extent.lowest + below, extent.highest + above);
      if (tolerance.lower > tolerance.upper || (!is_signed && tolerance.needs_sign())) continue;
      if (std::abs(tolerance.lower) < 1e-6 || std::abs(tolerance.upper) < 1e-6) continue;
      check(prove_tolerance(a, sites, tolerance), tolerance, extent, a, distance, is_signed);
    }
  const double farthest = std::max(std::abs(extent.lowest), std::abs(extent.highest));
  for (const double times : {0.5, 0.99, 1.01, 1.5}) {
    const Tolerance tolerance(times * farthest);
    check(prove_tolerance(a, sites, tolerance), tolerance, extent, a, distance, is_signed);
  }
}

TEST(ToleranceProof, AgreesWithDenseSamplesOfClosedMeshes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  const Mesh ball = sphere(2), box = cube(1), tube = ring(12, 1);
  for (int i = 0; i < 3; ++i) {
    const Vec3 by{0.4 * u(random), 0.4 * u(random), 0.4 * u(random)};
    SCOPED_TRACE(i);
    check_all(moved(cube(0.5), by), ball, 24);                         // inside, or across
    check_all(moved(sphere(1), by), box, 12);                          // across
    check_all(moved(cube(3), by), ball, 48);                           // around
    check_all(moved(sphere(1), by), tube, 12);                         // across a hole
    check_all(moved(sphere(1), 5 * Vec3{1, u(random), 0}), tube, 12);  // beside
  }
}

TEST(ToleranceProof, AgreesWithDenseSamplesOfOpenMeshes) {
  std::mt19937 random(4);
  for (const double height : {0.0, 0.3, 2.0}) {
    check_all(moved(sphere(1), {0.2, 0.1, height}), square(3, 0), 12);
    check_all(square(2, height), height_field(6), 48);
  }
  check_all(cube(0.7), soup(40, random), 24);
}

TEST(ToleranceProof, OfPartsAndTheirCopies) {
  for (const char* name : {"cow.off", "fandisk.off", "knot1.off"}) {
    const Mesh mesh = load(name, "fit");
    const Sites sites(mesh);
    for (const double limit : {0.0, 1e-6, 0.1})
      EXPECT_EQ(prove_tolerance(mesh, sites, limit).proof, Proof::holds) << name;
    const Mesh away = moved(mesh, {0, 0, 0.01});
    EXPECT_EQ(prove_tolerance(away, sites, 0.01).proof, Proof::holds) << name;
    EXPECT_EQ(prove_tolerance(away, sites, 0.02).proof, Proof::holds) << name;
    EXPECT_EQ(prove_tolerance(away, sites, 0.005).proof, Proof::fails) << name;
  }
}

// Asymmetric limits, where most of a part is near one and nothing may be near the other.
TEST(ToleranceProof, OfOneSideOfAPart) {
  const Mesh part = load("cow.off", "fit");
  const Sites sites(part);
  const auto prove = [&](double z, const Tolerance& tolerance) {
    return prove_tolerance(moved(part, {0, 0, z}), sites, tolerance).proof;
  };
  EXPECT_EQ(prove(0.01, {-0.011, 0.02}), Proof::holds);
  EXPECT_EQ(prove(0.01, {-0.02, 0.011}), Proof::holds);
  EXPECT_EQ(prove(0.01, {-0.001, 0.02}), Proof::fails);
  EXPECT_EQ(prove(0.01, {-0.02, 0.001}), Proof::fails);
  EXPECT_EQ(prove(5, {1, 10}), Proof::holds);
  EXPECT_EQ(prove(5, {-10, -1}), Proof::fails);
  EXPECT_EQ(prove(5, {4.9, 10}), Proof::fails);
}

// Unsigned distances are never negative.
TEST(ToleranceProof, OfUnsignedDistancesFromZero) {
  const Sites sites(square(4, 0));
  const Mesh on = square(2, 0);
  EXPECT_EQ(prove_tolerance(on, sites, Tolerance(0, 0.1)).proof, Proof::holds);
  EXPECT_EQ(prove_tolerance(square(2, 0.2), sites, Tolerance(0, 0.1)).proof, Proof::fails);
  EXPECT_EQ(prove_tolerance(on, sites, Tolerance(0.01, 0.1)).proof, Proof::fails);
  EXPECT_THROW((void)prove_tolerance(on, sites, Tolerance(-0.1, 0.2)), Error);
}

TEST(ToleranceProof, ForgivesTheAccuracy) {
  const Sites sites(square(4, 0));
  const Mesh above = square(2, 0.1);
  const auto prove = [&](const Tolerance& tolerance, double accuracy) {
    return prove_tolerance(above, sites, tolerance, {.accuracy = accuracy});
  };
  const ToleranceProof open = prove(0.099, 0.01);
  EXPECT_EQ(open.proof, Proof::undecided);
  ASSERT_TRUE(open.undecided_by);
  EXPECT_GE(*open.undecided_by, 0.001 - 1e-12);
  EXPECT_LE(*open.undecided_by, 0.01 + 1e-12);
  ASSERT_TRUE(open.witness);
  EXPECT_NEAR(open.witness->distance, 0.1, 1e-12);
  EXPECT_EQ(prove(0.099, 0.0009).proof, Proof::fails);
  EXPECT_EQ(prove(0.1001, 0.01).proof, Proof::holds) << "proven, however accurate a map is";
  const ToleranceProof below = prove({0.101, 0.2}, 0.01);
  EXPECT_EQ(below.proof, Proof::undecided);
  EXPECT_NEAR(below.undecided_by.value_or(0), 0.001, 1e-12);
  EXPECT_TRUE(below.at_lower);
}

// With estimated signs, |d| decides, or nothing does.
TEST(ToleranceProof, WithEstimatedSigns) {
  Mesh open = sphere(3);
  open.triangles.pop_back();
  const Sites sites(open);
  const Mesh inner = placed(sphere(3), "scale:0.5");
  const auto prove = [&](const Tolerance& tolerance) {
    return prove_tolerance(inner, sites, tolerance, {.sign = SignMethod::winding});
  };
  EXPECT_EQ(prove(0.6).proof, Proof::holds);
  EXPECT_EQ(prove(0.4).proof, Proof::fails);
  EXPECT_EQ(prove({-0.7, 0.6}).proof, Proof::holds);
  EXPECT_EQ(prove({-0.3, 0.4}).proof, Proof::fails);
  const ToleranceProof by_sign = prove({-0.6, 0.1});
  EXPECT_EQ(by_sign.proof, Proof::undecided);
  EXPECT_TRUE(by_sign.depends_on_signs);
  EXPECT_FALSE(by_sign.undecided_by);
}

TEST(ToleranceProof, OfSomeFaces) {
  const Mesh both = joined(square(2, 0.1), square(2, 1));
  const Sites sites(square(4, 0));
  const std::vector<std::uint32_t> low{0, 1}, high{2, 3}, none{9};
  EXPECT_EQ(prove_tolerance(both, sites, 0.2, {.faces = low}).proof, Proof::holds);
  const ToleranceProof found = prove_tolerance(both, sites, 0.2, {.faces = high});
  EXPECT_EQ(found.proof, Proof::fails);
  EXPECT_GE(found.witness->face, 2u);
  EXPECT_EQ(prove_tolerance(both, sites, 0.2).proof, Proof::fails);
  EXPECT_THROW((void)prove_tolerance(both, sites, 0.2, {.faces = none}), Error);
}

/// A prism along y over a profile in x and z, a plate with a step up to `height`.
Mesh stepped(double height) {
  const std::array<Vec2, 6> profile{{{0, 0}, {4, 0}, {4, 1}, {2, 1}, {2, height}, {0, height}}};
  Mesh mesh;
  for (const double y : {0.0, 2.0})
    for (const Vec2& p : profile) mesh.positions.push_back({p[0], y, p[1]});
  for (const auto& [a, b, c] : std::array<Triangle, 4>{{{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a + 6, c + 6, b + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, i + 6, j + 6});
    mesh.triangles.push_back({i, j + 6, j});
  }
  return mesh;
}

// Where surfaces coincide the distance is 0, which is within a limit of 0 with either sign.
TEST(ToleranceProof, OfALimitOfZeroWhereSurfacesTouch) {
  for (const char* pose : {"", "rotate:10:20:30", "rotate:10:20:30,translate:100:-70:30"}) {
    SCOPED_TRACE(pose);
    const auto part = [&](double height) { return placed(stepped(height), pose); };
    const Sites sites(part(3));
    const auto prove = [&](double height, const Tolerance& tolerance) {
      return prove_tolerance(part(height), sites, tolerance, {.most_parts = 20000}).proof;
    };
    EXPECT_EQ(prove(3.08, {0, 0.1}), Proof::holds);
    EXPECT_EQ(prove(3.08, {0, 0.05}), Proof::fails);
    EXPECT_EQ(prove(3.08, {-0.1, 0}), Proof::fails);
    EXPECT_EQ(prove(2.92, {-0.1, 0}), Proof::holds);
    EXPECT_EQ(prove(2.92, {0, 0.1}), Proof::fails);
    EXPECT_EQ(prove(3, {0, 0}), Proof::holds);
  }
}

// A contact at a limit of zero that distinguishes signs.
TEST(ToleranceProof, EndsAfterTheMostParts) {
  const Sites sites(cube(1));
  const Mesh part = moved(cube(1), {2, 0.3, 0.2});
  EXPECT_EQ(prove_tolerance(part, sites, {0, 5}, {.most_parts = 1000}).proof, Proof::holds);
  EXPECT_EQ(prove_tolerance(moved(part, {-0.01, 0, 0}), sites, {0, 5}).proof, Proof::fails);
  EXPECT_EQ(prove_tolerance(moved(part, {0.01, 0, 0}), sites, {0, 5}).proof, Proof::holds);
}

// Cubes of 2 and 3 have their faces 0.5 apart: the smaller one is inside.
TEST(ToleranceProof, OfALimitOnOneSide) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Mesh small = cube(1), large = cube(1.5);
  const auto prove = [](const Mesh& a, const Mesh& b, double lo, double hi) {
    return prove_tolerance(a, Sites(b), Tolerance(lo, hi)).proof;
  };
  EXPECT_EQ(prove(small, large, -kNone, 0.1), Proof::holds);
  EXPECT_EQ(prove(small, large, -0.4, kNone), Proof::fails);
  EXPECT_EQ(prove(small, large, -0.6, kNone), Proof::holds);
  EXPECT_EQ(prove(small, large, -kNone, -0.4), Proof::holds);
  EXPECT_EQ(prove(small, large, -kNone, -0.55), Proof::fails);
  EXPECT_EQ(prove(large, small, 0.4, kNone), Proof::holds);
  EXPECT_EQ(prove(large, small, 0.55, kNone), Proof::fails);
  EXPECT_EQ(prove(square(2, 0.2), square(4, 0), -kNone, 0.3), Proof::holds) << "unsigned";
  EXPECT_EQ(prove(square(2, 0.2), square(4, 0), -kNone, 0.1), Proof::fails) << "unsigned";
}

// The boxes of spheres are farther apart than half of the limit.
TEST(ToleranceProof, FindsTheLeastDistance) {
  const Mesh a = moved(sphere(2), {0, 0, 2.3}), b = sphere(2);
  const ToleranceProof found = prove_tolerance(a, Sites(b), Tolerance(0.4, 10));
  EXPECT_EQ(found.proof, Proof::fails);
  ASSERT_TRUE(found.witness);
  EXPECT_NEAR(found.witness->distance, 0.3, 1e-12);
  EXPECT_TRUE(found.at_lower);
}

TEST(ToleranceProof, RejectsWhatHasNoMeaning) {
  const Sites sites(cube(1));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)prove_tolerance(cube(1), sites, Tolerance(1, 0)), Error);
  EXPECT_THROW((void)prove_tolerance(cube(1), sites, Tolerance(kNan)), Error);
  EXPECT_THROW((void)prove_tolerance(cube(1), sites, Tolerance(std::numeric_limits<double>::infinity())),
               Error);
  EXPECT_THROW((void)prove_tolerance(cube(1), sites, 1, {.accuracy = -1}), Error);
  EXPECT_THROW((void)prove_tolerance(Mesh(), sites, 1), Error);
}

}  // namespace
}  // namespace sdm::test

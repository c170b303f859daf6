// Hausdorff distances to the faces that face the same way.
#include <gtest/gtest.h>
#include <sdm/hausdorff.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "closest/facing/facing_search.h"
#include "geometry/point_triangle.h"
#include "sites/sites_data.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

Vec3 unit_normal(const Mesh& mesh, std::uint32_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  return normalized(cross(b - a, c - a));
}

/// The distance of a point to the faces of B that are allowed for a normal; infinite if there are none. The
/// meshes are wound outwards.
double to_allowed(const Mesh& b, const Vec3& p, const Vec3& normal, double angle) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < b.triangles.size(); ++f) {
    const double cosine = dot(unit_normal(b, f), normal);
    if (angle == 90 ? cosine > 0 : cosine >= std::cos(angle * std::numbers::pi / 180) - 1e-12)
      least = std::min(least, norm(p - closest_on_triangle(p, corners_of(b, f))));
  }
  return least;
}

struct Sampled {
  double largest = 0;  ///< of points of a grid on each face
  double apart = 0;    ///< no point of a face is farther from one of them
  std::size_t unmatched = 0;
};

Sampled sample(const Mesh& a, const Mesh& b, double angle, int n) {
  Sampled result;
  for (std::uint32_t f = 0; f < a.triangles.size(); ++f) {
    const auto [p, q, r] = corners_of(a, f);
    const Vec3 normal = unit_normal(a, f);
    if (std::isinf(to_allowed(b, p, normal, angle))) {
      ++result.unmatched;
      continue;
    }
    result.apart = std::max({result.apart, norm(q - p) / n, norm(r - q) / n, norm(p - r) / n});
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 at = p + (static_cast<double>(i) / n) * (q - p) + (static_cast<double>(j) / n) * (r - p);
        result.largest = std::max(result.largest, to_allowed(b, at, normal, angle));
      }
  }
  return result;
}

std::vector<std::pair<Mesh, Mesh>> facing_pairs() {
  return {{sphere(2), placed(torus(12, 8), "rotate:1:2:3")},
          {torus(12, 8), cube(0.7)},
          {cube(1), sphere(2)},
          {placed(cube(1), "rotate:10:20:30"), cube(1)},
          {square(1, 0.5), height_field(8)}};
}

TEST(FacingHausdorff, BoundsContainTheLargestOfADenseSample) {
  for (const auto& [a, b] : facing_pairs())
    for (const double angle : {20.0, 60.0, 90.0, 140.0, 180.0}) {
      SCOPED_TRACE(angle);
      const Sampled expected = sample(a, b, angle, 12);
      if (expected.unmatched == a.triangles.size()) {
        EXPECT_NE(error_of([&] { (void)one_sided_hausdorff(a, Sites(b), {.facing = angle}); }), "");
        continue;
      }
      const HausdorffDistance found = one_sided_hausdorff(a, Sites(b), {.facing = angle});
      const BoundedLength& d = found.distance;
      EXPECT_EQ(found.faces_without_match, expected.unmatched);
      EXPECT_EQ(found.area_without_match > 0, expected.unmatched > 0);
      EXPECT_GE(d.upper, expected.largest - 1e-12);
      EXPECT_LE(d.lower, expected.largest + expected.apart);
      EXPECT_LE(d.upper - d.lower, 1.1e-6 * 10);
      // The witness is a point of its face, with this distance.
      const Vec3& p = (*d.witness)[0];
      EXPECT_NEAR(to_allowed(b, p, unit_normal(a, found.faces[0]), angle), d.value, 1e-9);
      EXPECT_LE(norm(p - closest_on_triangle(p, corners_of(a, found.faces[0]))), 1e-9);
    }
}

TEST(FacingHausdorff, OfAllAnglesIsTheHausdorffDistance) {
  for (const auto& [a, b] : facing_pairs()) {
    const double plain = one_sided_hausdorff(a, Sites(b)).distance.value,
                 all = one_sided_hausdorff(a, Sites(b), {.facing = 180}).distance.value;
    EXPECT_NEAR(plain, all, 2e-6 * 5);
  }
}

/// A plate of n × n squares, closed, 1 thick and 20 wide; the top is at 1 and comes first.
Mesh plate(std::uint32_t n) {
  Mesh mesh;
  const std::uint32_t row = n + 1, bottom = row * row;
  for (const double z : {1.0, 0.0})
    for (std::uint32_t i = 0; i < bottom; ++i)
      mesh.positions.push_back({20.0 * (i % row) / n, 20.0 * (i / row) / n, z});
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * row + i, b = a + row;
      quad(a, a + 1, b + 1, b);
      quad(bottom + a, bottom + b, bottom + b + 1, bottom + a + 1);
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto wall = [&](std::uint32_t from, std::uint32_t to) {
      quad(to, from, bottom + from, bottom + to);
    };
    wall(i, i + 1);
    wall(n * row + i + 1, n * row + i);
    wall((i + 1) * row, i * row);
    wall(i * row + n, (i + 1) * row + n);
  }
  return mesh;
}

// The top of a plate has a dent that is deeper than half of it.
TEST(FacingHausdorff, FindsADentDeeperThanHalfOfAWall) {
  const Mesh whole = plate(16);
  Mesh dented = whole;
  for (Vec3& p : dented.positions)
    if (p[2] == 1 && std::hypot(p[0] - 10, p[1] - 10) < 3) p[2] -= 0.8;
  constexpr double wall = 1;
  const Sites sites(whole);
  ASSERT_TRUE(sites.closed());
  EXPECT_LE(one_sided_hausdorff(dented, sites).distance.upper, 0.51 * wall);
  const HausdorffDistance found = one_sided_hausdorff(dented, sites, {.facing = 90});
  EXPECT_NEAR(found.distance.value, 0.8 * wall, 1e-5 * wall);
  const SymmetricHausdorff both = symmetric_hausdorff(Sites(dented), sites, {.facing = 90});
  EXPECT_GE(both.larger.distance.lower, 0.79 * wall);

  const ToleranceProof fails = prove_tolerance(dented, sites, 0.6 * wall, {.facing = 90}),
                       passes = prove_tolerance(dented, sites, 0.81 * wall, {.facing = 90});
  EXPECT_EQ(fails.proof, Proof::fails);
  ASSERT_TRUE(fails.witness);
  EXPECT_LT(fails.witness->distance, -0.6 * wall) << "behind the face that it is matched with";
  EXPECT_EQ(passes.proof, Proof::holds);
  EXPECT_EQ(prove_tolerance(dented, sites, 0.6 * wall).proof, Proof::holds) << "to the other skin";
  const ToleranceProof one_sided = prove_tolerance(dented, sites, {-0.9 * wall, 0.1 * wall}, {.facing = 90});
  EXPECT_EQ(one_sided.proof, Proof::undecided);
  EXPECT_TRUE(one_sided.depends_on_signs);
}

// A square over a box, whose lower side faces down: unsigned distances are proven on both sides.
TEST(FacingHausdorff, ProvesALowerLimitOfUnsignedDistances) {
  const Sites sites(cube(1));
  const Mesh over = square(0.5, 1.5);
  const auto prove = [&](double lo, double hi) {
    return prove_tolerance(over, sites, {lo, hi}, {.sign = SignMethod::none, .facing = 90});
  };
  EXPECT_EQ(prove(0.4, 0.6).proof, Proof::holds);
  EXPECT_EQ(prove(0.1, 0.45).proof, Proof::fails);
  const ToleranceProof low = prove(0.55, 0.6);
  EXPECT_EQ(low.proof, Proof::fails);
  EXPECT_FALSE(low.depends_on_signs);
  EXPECT_TRUE(low.at_lower);
  ASSERT_TRUE(low.witness);
  EXPECT_NEAR(low.witness->distance, 0.5, 1e-9);
  Mesh turned = over;
  for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(prove_tolerance(turned, sites, {2.4, 2.6}, {.sign = SignMethod::none, .facing = 90}).proof,
            Proof::holds)
      << "to the lower side";
}

TEST(FacingHausdorff, StatesFacesWithoutAMatch) {
  // The side walls of a box have no match in a square that faces upwards.
  const Mesh box = cube(1), ground = square(1, 0);
  const Sites sites(ground);
  const HausdorffDistance found = one_sided_hausdorff(box, sites, {.facing = 30});
  EXPECT_EQ(found.faces_without_match, 10U);
  EXPECT_NEAR(found.area_without_match, 5.0 / 6, 1e-12);
  const ToleranceProof proof = prove_tolerance(box, sites, 100, {.facing = 30});
  EXPECT_EQ(proof.proof, Proof::fails) << "they have no distance";
  EXPECT_EQ(proof.faces_without_match, 10U);
  EXPECT_FALSE(proof.witness);
  // Of the top alone.
  std::vector<std::uint32_t> top;
  for (std::uint32_t f = 0; f < box.triangles.size(); ++f)
    if (unit_normal(box, f)[2] > 0.9) top.push_back(f);
  EXPECT_EQ(prove_tolerance(box, sites, 100, {.facing = 30, .faces = top}).proof, Proof::holds);
}

/// n × n squares of 1 / n with noise of their size.
Mesh rough_terrain(int n) {
  Mesh terrain = height_field(n);
  for (Vec3& p : terrain.positions) {
    const double x = n * p[0], y = n * p[1];
    p[2] = 0.8 / n * std::sin(7 * x + 131 * y) * std::sin(97 * x * y + 3);
  }
  return terrain;
}

// Most faces of rough terrain have few matches in other terrain turned over, far away, or none: searches of
// them go over to the matches themselves.
TEST(FacingHausdorff, OfRoughTerrainTurnedOverEqualsBruteForceAtVertices) {
  const Mesh terrain = rough_terrain(16);
  Mesh turned = rough_terrain(64);
  for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
  double largest = 0;
  std::size_t unmatched = 0;
  for (std::uint32_t f = 0; f < terrain.triangles.size(); ++f) {
    const Vec3 normal = unit_normal(terrain, f);
    std::array<double, 3> d{};
    const Corners corners = corners_of(terrain, f);
    for (int k = 0; k < 3; ++k) d[k] = to_allowed(turned, corners[k], normal, 90);
    if (std::isinf(d[0]))
      ++unmatched;
    else
      largest = std::max({largest, d[0], d[1], d[2]});
  }
  ASSERT_GT(unmatched, 5U);
  ASSERT_LT(unmatched, terrain.triangles.size());
  constexpr double tolerance = 1e-4;
  const HausdorffDistance found =
      one_sided_hausdorff(terrain, Sites(turned), {.precision = tolerance, .facing = 90});
  EXPECT_EQ(found.faces_without_match, unmatched);
  EXPECT_GE(found.distance.lower, largest - tolerance);
  EXPECT_GE(found.distance.upper, largest - 1e-12);
  // Edges are shorter than 2.2 / 16, and points of a face within 0.58 edges of a corner.
  EXPECT_LE(found.distance.upper, largest + tolerance + 0.58 * 2.2 / 16);
}

TEST(FacingSearch, ListsTheFewFacesThatAreAllowed) {
  Mesh turned = rough_terrain(64);
  for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
  const Sites sites(turned);
  const auto faces = static_cast<std::uint32_t>(turned.triangles.size());
  const auto few = static_cast<std::size_t>(std::sqrt(faces));
  ASSERT_GT(few, 64U);
  const Mesh directions = sphere(3);
  int listed = 0, none = 0, many = 0;
  for (const double angle : {20.0, 90.0, 140.0}) {
    const facing::FacingSearch search(internals(sites), angle);
    for (const Vec3& normal : directions.positions) {
      std::vector<std::uint32_t> allowed;
      for (std::uint32_t f = 0; f < faces; ++f)
        if (search.allows(normal, f)) allowed.push_back(f);
      auto found = search.few_allowed(normal);
      ASSERT_EQ(found.has_value(), allowed.size() <= few);
      if (!found) {
        ++many;
        continue;
      }
      ++(allowed.empty() ? none : listed);
      std::ranges::sort(*found);
      EXPECT_EQ(*found, allowed);
    }
  }
  EXPECT_GT(listed, 10);
  EXPECT_GT(none, 10);
  EXPECT_GT(many, 10);
}

TEST(FacingHausdorff, RejectsWhatItCannotCompute) {
  const Mesh box = cube(1);
  const Sites sites(box);
  for (const double angle : {0.0, -1.0, 181.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(error_of([&] { (void)one_sided_hausdorff(box, sites, {.facing = angle}); }), "");
    EXPECT_NE(error_of([&] { (void)prove_tolerance(box, sites, 1, {.facing = angle}); }), "");
  }
  EXPECT_NE(
      error_of([&] { (void)prove_tolerance(box, sites, 1, {.sign = SignMethod::exact, .facing = 90}); }), "");
}

}  // namespace
}  // namespace sdm::test

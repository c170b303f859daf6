// Intersections of the faces of a mesh, against CGAL and brute force.
#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/sites.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "sites/intersecting_faces.h"
#include "sites/sites_data.h"
#include "support/meshes.h"
#include "support/pair_oracle.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

std::size_t shared_corners(const Triangle& a, const Triangle& b) {
  return static_cast<std::size_t>(
      std::ranges::count_if(a, [&](std::uint32_t v) { return std::ranges::find(b, v) != b.end(); }));
}

/// The pairs without shared corners, by exact arithmetic.
Pairs disjoint_pairs(const Mesh& mesh) {
  const auto corners = [&](const Triangle& t) {
    return Corners{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  };
  Pairs pairs;
  for (std::uint32_t a = 0; a < mesh.triangles.size(); ++a)
    for (std::uint32_t b = a + 1; b < mesh.triangles.size(); ++b)
      if (shared_corners(mesh.triangles[a], mesh.triangles[b]) == 0 &&
          oracle::intersect(corners(mesh.triangles[a]), corners(mesh.triangles[b])))
        pairs.push_back({a, b});
  return pairs;
}

void expect_disjoint_pairs(const Mesh& mesh) {
  const Sites sites(mesh);
  Pairs found = self_intersections(sites);
  EXPECT_TRUE(std::ranges::is_sorted(found));
  EXPECT_EQ(is_embedded(sites), found.empty());
  std::erase_if(found, [&](const auto& pair) {
    return shared_corners(mesh.triangles[pair[0]], mesh.triangles[pair[1]]) > 0;
  });
  EXPECT_EQ(found, disjoint_pairs(mesh));
}

TEST(SelfIntersections, AgreeWithExactArithmetic) {
  std::mt19937 random(1);
  expect_disjoint_pairs(test::soup(300, random));
  const Mesh cube = test::cube(1);
  for (const char* steps : {"translate:1:0:0", "translate:2:0:0", "translate:2:2:2", "translate:2.001:0:0",
                            "rotate:45:0:0", "scale:0.5", "scale:0.5,translate:0.5:0:0"}) {
    SCOPED_TRACE(steps);
    expect_disjoint_pairs(test::joined(cube, test::placed(cube, steps)));
  }
  Mesh noisy = test::sphere(2);
  std::uniform_real_distribution<double> u(-0.2, 0.2);
  for (Vec3& p : noisy.positions) p = p + Vec3{u(random), u(random), u(random)};
  expect_disjoint_pairs(noisy);
}

TEST(SelfIntersections, EmbeddedMeshesHaveNone) {
  for (const char* name : {"elephant.off", "knot1.off", "fandisk.off", "hand.off"}) {
    SCOPED_TRACE(name);
    const Sites sites(test::load(name));
    EXPECT_TRUE(is_embedded(sites));
    EXPECT_TRUE(self_intersections(sites).empty());
  }
  EXPECT_TRUE(is_embedded(Sites(test::height_field(20))));
  EXPECT_TRUE(is_embedded(Sites(test::sphere(3))));
}

// Faces 0 1 2 and 0 3 4 share corner 0.
TEST(SelfIntersections, OfFacesThatShareACorner) {
  const auto embedded = [](const Vec3& three, const Vec3& four) {
    return is_embedded(
        Sites(Mesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, three, four}, {{0, 1, 2}, {0, 3, 4}}, {}}));
  };
  EXPECT_TRUE(embedded({0, 0, 1}, {1, 1, 1})) << "above";
  EXPECT_TRUE(embedded({-1, 0, 0}, {0, -1, 0})) << "beside, in one plane";
  EXPECT_TRUE(embedded({2, -1, 1}, {2, -1, -1})) << "through the plane, beside";
  EXPECT_FALSE(embedded({1, 1, 1}, {1, 1, -1})) << "through the face";
  EXPECT_FALSE(embedded({0.2, 0.2, 1}, {0.2, 0.2, -1})) << "through the face, smaller";
  EXPECT_FALSE(embedded({9, 9, 1}, {9, 9, -1})) << "through the face, larger";
  EXPECT_FALSE(embedded({1, 0.5, 0}, {0.5, 1, 0})) << "within, in one plane";
  EXPECT_FALSE(embedded({4, -1, 0}, {-1, 4, 0})) << "around, in one plane";
  EXPECT_FALSE(embedded({1, 0, 0}, {0, 0, 1})) << "on a side";
  EXPECT_FALSE(embedded({3, 0, 0}, {0, 0, 1})) << "on a side, longer";
}

// On a small grid, where many corners touch planes and edges, and the same slightly off it. Faces that share
// a corner intersect beyond it if and only if the side across from it of one of them meets the other.
TEST(SelfIntersections, OfFacesThatShareACornerAgreeWithExactArithmetic) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> grid(-2, 2);
  std::uniform_real_distribution<double> off(-1e-13, 1e-13);
  int intersecting = 0;
  for (int i = 0; i < 4000; ++i) {
    Mesh mesh{std::vector<Vec3>(5), {{0, 1, 2}, {0, 3, 4}}, {}};
    for (Vec3& p : mesh.positions)
      for (double& x : p) x = grid(random) + (i % 2 == 0 ? 0 : off(random));
    const auto corners = [&](const Triangle& t) {
      return Corners{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    };
    const Corners a = corners({0, 1, 2}), b = corners({0, 3, 4});
    const auto has_area = [](const Corners& t) { return cross(t[1] - t[0], t[2] - t[0]) != Vec3{}; };
    if (!has_area(a) || !has_area(b)) continue;
    const bool expected =
        oracle::intersect(corners({1, 2, 2}), b) || oracle::intersect(corners({3, 4, 4}), a);
    intersecting += expected;
    ASSERT_EQ(is_embedded(Sites(mesh)), !expected) << i;
  }
  EXPECT_GT(intersecting, 400);
}

// Faces 0 1 2 and 1 0 3 share an edge.
TEST(SelfIntersections, OfFacesThatShareAnEdge) {
  const auto embedded = [](const Vec3& three) {
    return is_embedded(Sites(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, three}, {{0, 1, 2}, {1, 0, 3}}, {}}));
  };
  EXPECT_TRUE(embedded({0, -1, 0}));
  EXPECT_TRUE(embedded({0, 1, 1e-300})) << "almost folded";
  EXPECT_TRUE(embedded({0, 0, 1}));
  EXPECT_FALSE(embedded({0, 0.5, 0}));
  EXPECT_FALSE(embedded({5, 2, 0}));
}

TEST(SelfIntersections, IgnoreFacesWithoutSites) {
  Mesh mesh = test::tetrahedron();
  mesh.triangles.push_back({2, 1, 0});  // a duplicate
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_TRUE(is_embedded(Sites(mesh)));
}

// Many faces around a vertex, an edge, or both, in all numbers of common corners; many of them intersect.
Mesh around_hubs(int faces, std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  std::uniform_int_distribution<int> grid(-2, 2), kind(0, 5);
  Mesh mesh{{{0, 0, 0}, {0, 0, 1}, {1, 0.5, 0.25}}, {}, {}};
  const auto point = [&](bool on_grid) {
    mesh.positions.push_back(on_grid ? Vec3{1. * grid(random), 1. * grid(random), 1. * grid(random)}
                                     : Vec3{u(random), u(random), u(random)});
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  for (int f = 0; f < faces; ++f) {
    const bool on_grid = f % 3 == 0;  // coplanar faces, and directions that agree
    switch (kind(random)) {
      case 0:
        mesh.triangles.push_back({0, 1, point(on_grid)});
        break;
      case 1:
        mesh.triangles.push_back({2, point(on_grid), 0});
        break;
      case 2:
        mesh.triangles.push_back({point(on_grid), 1, point(on_grid)});
        break;
      case 3:
        mesh.triangles.push_back({2, point(on_grid), point(on_grid)});
        break;
      default:
        mesh.triangles.push_back({0, point(on_grid), point(on_grid)});
    }
  }
  mesh.triangles.push_back({point(false), point(false), point(false)});
  return mesh;
}

TEST(SelfIntersections, OfManyFacesAroundVerticesAndEdgesAreThoseOfAllPairs) {
  std::mt19937 random(8);
  for (int round = 0; round < 2; ++round) {
    const Sites sites(around_hubs(round == 0 ? 1600 : 900, random));
    const sites::SitesData& data = internals(sites);
    const sites::FaceSoup soup{data.mesh.positions, data.mesh.triangles, data.tree};
    Pairs all;
    std::vector<std::uint32_t> faces(data.tree.items.begin(), data.tree.items.end());
    std::ranges::sort(faces);
    for (std::size_t a = 0; a < faces.size(); ++a)
      for (std::size_t b = a + 1; b < faces.size(); ++b)
        if (sites::faces_intersect(soup, faces[a], faces[b])) all.push_back({faces[a], faces[b]});
    EXPECT_GT(all.size(), 1000u);
    EXPECT_EQ(self_intersections(sites), all);
    EXPECT_EQ(self_intersections(sites, std::uint64_t{1} << 40).pairs, all);
    const SelfIntersections some = self_intersections(sites, all.size() - 1);
    EXPECT_FALSE(some.all);
    EXPECT_TRUE(std::ranges::includes(all, some.pairs));
    EXPECT_FALSE(is_embedded(sites));
  }
}

// All pairs of these faces touch: testing each would take minutes.
TEST(SelfIntersections, OfManyFacesAtOneVertexOrEdgeEnd) {
  constexpr int kFaces = 50'000;
  Mesh wheel{{{0, 0, 1}}, {}, {}}, book{{{0, 0, 0}, {0, 0, 1}}, {}, {}}, star{{{0, 0, 0}}, {}, {}};
  for (int i = 0; i < kFaces; ++i) {
    const double angle = 2 * std::numbers::pi * i / kFaces;
    const Vec3 at{std::cos(angle), std::sin(angle), 0.1 * std::sin(9 * angle)};
    wheel.positions.push_back(at);
    book.positions.push_back(at);
    const auto n = static_cast<std::uint32_t>(i);
    wheel.triangles.push_back({0, n + 1, (n + 1) % kFaces + 1});
    book.triangles.push_back({0, 1, n + 2});
  }
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (std::uint32_t i = 0; i < 10'000; ++i) {  // thin tetrahedra
    const Vec3 tip = normalized(Vec3{normal(random), normal(random), normal(random)});
    const Vec3 side = 1e-6 * normalized(cross(tip, {0.3, 0.5, 0.7})), other = cross(tip, side);
    const std::uint32_t a = 3 * i + 1, b = a + 1, c = a + 2;
    for (const Vec3& p : {tip + side, tip + other, tip - side - other}) star.positions.push_back(p);
    for (const Triangle& t : {Triangle{0, b, a}, {0, c, b}, {0, a, c}, {a, b, c}})
      star.triangles.push_back(t);
  }
  for (const Mesh* mesh : {&wheel, &book, &star}) {
    const Sites sites(*mesh);
    EXPECT_TRUE(is_embedded(sites));
    const SelfIntersections found = self_intersections(sites, self_intersection_budget(sites));
    EXPECT_TRUE(found.all);
    EXPECT_TRUE(found.pairs.empty());
  }
  EXPECT_NEAR(solid_volume(Sites(star)).lower, 10'000 * 1.5e-12 / 3, 1e-6 * 10'000 * 1.5e-12);
}

// Each crosses half of the others.
TEST(SelfIntersections, OfNeedlesAreNotDetermined) {
  Mesh mesh;
  constexpr int kNeedles = 30'000;
  for (int i = 0; i < kNeedles; ++i) {
    const double at = static_cast<double>(i / 2) / kNeedles, width = 0.3 / kNeedles;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : {Vec3{-1, at, -0.1}, Vec3{2, at, 0.1}, Vec3{2, at + width, 0.2}})
      mesh.positions.push_back(i % 2 == 0 ? p : Vec3{p[1], p[0], -p[2]});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const Sites sites(mesh);
  EXPECT_FALSE(is_embedded(sites));
  const SelfIntersections found = self_intersections(sites, 1'000'000);
  EXPECT_FALSE(found.all);
  EXPECT_GT(found.pairs.size(), 100'000u);
  EXPECT_LE(found.pairs.size(), 1'000'000u);
  const ThreadLimit one(1);
  EXPECT_EQ(self_intersections(sites, 1'000'000).pairs, found.pairs);
}

}  // namespace
}  // namespace sdm

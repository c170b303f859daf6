#include <gtest/gtest.h>
#include <sdm/execution.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "sites/sites_data.h"
#include "support/shapes.h"

namespace sdm {
namespace {

// Large enough for every parallel loop to be cut; a second shell, holes, slivers, duplicates, edges of three
// faces.
Mesh rough_torus() {
  Mesh mesh = test::torus(120, 80);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-0.02, 0.02);
  for (Vec3& p : mesh.positions) p = p + Vec3{u(random), u(random), u(random)};
  mesh = test::joined(mesh, test::band(100, true));
  for (int i = 0; i < 200; ++i) {
    const auto vertex = [&] { return static_cast<std::uint32_t>(random() % mesh.positions.size()); };
    const Triangle t = mesh.triangles[random() % mesh.triangles.size()];
    mesh.triangles.insert(mesh.triangles.end(),
                          {{t[1], t[0], t[2]}, {t[0], t[1], vertex()}, {t[0], t[0], t[1]}});
  }
  return mesh;
}

bool same_bits(const auto& a, const auto& b) {
  return std::ranges::equal(std::as_bytes(std::span(a)), std::as_bytes(std::span(b)));
}

void expect_same(const sites::SitesData& a, const sites::SitesData& b) {
  EXPECT_TRUE(same_bits(a.topology.edges, b.topology.edges));
  EXPECT_TRUE(same_bits(a.topology.face_edges, b.topology.face_edges));
  EXPECT_TRUE(same_bits(a.topology.incident.offsets, b.topology.incident.offsets));
  EXPECT_TRUE(same_bits(a.topology.incident.items, b.topology.incident.items));
  EXPECT_TRUE(same_bits(a.vertex_faces.items, b.vertex_faces.items));
  EXPECT_TRUE(same_bits(a.orientation.flipped, b.orientation.flipped));
  EXPECT_TRUE(same_bits(a.orientation.component, b.orientation.component));
  EXPECT_TRUE(same_bits(a.inverted, b.inverted));
  EXPECT_TRUE(same_bits(a.tree.nodes, b.tree.nodes));
  EXPECT_TRUE(same_bits(a.tree.items, b.tree.items));
  EXPECT_TRUE(same_bits(a.regions.leaves, b.regions.leaves));
  EXPECT_TRUE(same_bits(a.regions.bounds, b.regions.bounds));
  EXPECT_TRUE(same_bits(a.regions.owners, b.regions.owners));
  EXPECT_TRUE(same_bits(a.regions.faces, b.regions.faces));
  EXPECT_TRUE(same_bits(a.regions.edges, b.regions.edges));
  EXPECT_TRUE(same_bits(a.regions.vertices, b.regions.vertices));
  EXPECT_TRUE(same_bits(a.regions.places.neighbours, b.regions.places.neighbours));
  EXPECT_TRUE(same_bits(a.regions.enclosed, b.regions.enclosed));
  EXPECT_TRUE(same_bits(a.regions.places.corners, b.regions.places.corners));
  EXPECT_TRUE(same_bits(a.regions.places.edges, b.regions.places.edges));
  EXPECT_TRUE(same_bits(a.regions.places.fans.items, b.regions.places.fans.items));
  EXPECT_TRUE(same_bits(a.normals.face, b.normals.face));
  EXPECT_TRUE(same_bits(a.normals.vertex, b.normals.vertex));
  EXPECT_TRUE(same_bits(a.sliver, b.sliver));
}

TEST(Sites, DoNotDependOnTheNumberOfThreads) {
  for (const Mesh& mesh : {rough_torus(), test::torus(200, 100)}) {
    const Sites many(mesh);
    const ThreadLimit one(1);
    expect_same(internals(many), internals(Sites(mesh)));
  }
}

TEST(Sites, RefitToTheSamePositionsChangesNothing) {
  const Mesh mesh = rough_torus();
  const Sites fresh(mesh);
  Sites refitted(mesh);
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p = 1.5 * p + Vec3{0.1, 0.2 * p[0], 0};
  refitted.refit(moved);
  refitted.refit(mesh.positions);
  expect_same(internals(fresh), internals(refitted));
}

// A neighbourhood of any size is no more than sorted.
TEST(Sites, AcceptManyFacesAroundOneEdge) {
  Mesh fan{{{0, 0, 0}, {0, 0, 1}}, {}, {}};
  const std::uint32_t count = 100000;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    fan.positions.push_back({std::cos(angle), std::sin(angle), 0.5});
    fan.triangles.push_back({0, 1, 2 + i});
    fan.triangles.push_back({2 + i, 1, 0});
  }
  const Sites sites(fan);
  EXPECT_EQ(sites.edges().size(), 2 * count + 1);
  EXPECT_EQ(internals(sites).topology.duplicate_faces, count);
  EXPECT_EQ(internals(sites).topology.edge_faces(0).size(), count);
}

}  // namespace
}  // namespace sdm

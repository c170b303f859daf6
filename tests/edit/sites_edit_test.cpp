// Sites after edits answer as those built anew from the edited mesh.
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/sites.h>

#include "edit/random_edits.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"
#include "support/arrays.h"  // IWYU pragma: keep, for EXPECT_EQ
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

std::vector<Vec3> queries(const Mesh& mesh, std::mt19937& random) {
  std::vector<Vec3> points = test::random_surface_points(mesh, 20, random);
  for (int i = 0; i < 40; ++i) points.push_back(test::random_point(bounds(mesh), random));
  for (int i = 0; i < 20; ++i) points.push_back(mesh.positions[random() % mesh.positions.size()]);
  return points;
}

// All that queries are computed from, but for the order in the tree.
void expect_same_data(const sites::SitesData& a, const sites::SitesData& b) {
  EXPECT_EQ(a.topology.edges, b.topology.edges);
  EXPECT_EQ(a.topology.face_edges, b.topology.face_edges);
  EXPECT_EQ(a.topology.incident.offsets, b.topology.incident.offsets);
  EXPECT_EQ(a.topology.incident.items, b.topology.incident.items);
  EXPECT_EQ(a.topology.collapsed_faces, b.topology.collapsed_faces);
  EXPECT_EQ(a.topology.duplicate_faces, b.topology.duplicate_faces);
  EXPECT_EQ(a.vertex_faces.offsets, b.vertex_faces.offsets);
  EXPECT_EQ(a.vertex_faces.items, b.vertex_faces.items);
  EXPECT_EQ(a.orientation.flipped, b.orientation.flipped);
  EXPECT_EQ(a.orientation.component, b.orientation.component);
  EXPECT_EQ(a.orientation.first_face, b.orientation.first_face);
  EXPECT_EQ(a.closed, b.closed);
  EXPECT_EQ(a.orientation.orientable, b.orientation.orientable);
  EXPECT_EQ(a.consistently_oriented, b.consistently_oriented);
  EXPECT_EQ(a.inverted, b.inverted);
  EXPECT_EQ(a.frame.scale, b.frame.scale);
  EXPECT_EQ(a.frame.origin, b.frame.origin);
  EXPECT_EQ(a.normals.face, b.normals.face);
  EXPECT_EQ(a.sliver, b.sliver);
  double off = 0;  // sums in another order
  for (std::size_t v = 0; v < a.normals.vertex.size(); ++v)
    off = std::max(off, norm(a.normals.vertex[v] - b.normals.vertex[v]));
  EXPECT_LE(off, 1e-12);
  std::vector<std::uint32_t> of_a(a.tree.items.begin(), a.tree.items.end()),
      of_b(b.tree.items.begin(), b.tree.items.end());
  std::ranges::sort(of_a);
  std::ranges::sort(of_b);
  EXPECT_EQ(of_a, of_b);
}

void expect_same_answers(const Sites& edited, const Sites& fresh, std::span<const Vec3> points) {
  const double length = diagonal(bounds(fresh.mesh()));
  // In double precision the distances are equal to the last bit; where two sites are equally close, either
  // may be found.
  const ClosestPointOptions exact{.engine = make_engine("reference")};
  const auto a = closest_points(edited, points, exact), b = closest_points(fresh, points, exact);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(a[i].distance, b[i].distance) << i;
    if (a[i].type == b[i].type) {
      EXPECT_LE(a[i].site == b[i].site ? norm(a[i].point - b[i].point) : 0, 1e-12 * length) << i;
    }
    EXPECT_NEAR(norm(a[i].point - points[i]), b[i].distance, 1e-12 * length) << i;
  }
  const auto c = closest_points(edited, points), d = closest_points(fresh, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(c[i].distance, b[i].distance, 1e-6 * length) << i;
    EXPECT_NEAR(d[i].distance, b[i].distance, 1e-6 * length) << i;
  }
  const SignMethod method = choose_sign(fresh, SignMethod::automatic).method;
  EXPECT_EQ(choose_sign(edited, SignMethod::automatic).method, method);
  EXPECT_EQ(inside_flags(edited, points, a, method), inside_flags(fresh, points, b, method));
}

class EditedMesh : public testing::TestWithParam<unsigned> {};

TEST_P(EditedMesh, AnswersAsBuiltAnew) {
  const unsigned seed = GetParam();
  std::mt19937 random(seed);
  Mesh mesh = seed % 2 == 0 ? test::torus(14, 10)
                            : test::joined(test::sphere(2), test::moved(test::band(40, false), {3, 0, 0}));
  mesh.corner_uvs.clear();
  Sites sites(mesh);
  test::RandomEdits edits(seed, {.moves = true, .defects = seed % 3 == 2});
  for (int i = 0; i < 120; ++i) {
    SCOPED_TRACE(i);
    const MeshEdit edit = edits.next(mesh);
    apply(mesh, edit);
    sites.edit(edit);
    ASSERT_EQ(sites.mesh().triangles, mesh.triangles);
    ASSERT_EQ(sites.mesh().positions, mesh.positions);
    const Sites fresh(mesh);
    expect_same_data(internals(sites), internals(fresh));
    const std::vector<Vec3> points = queries(mesh, random);
    expect_same_answers(sites, fresh, points);
    if (i % 10 == 0) {
      const double length = diagonal(bounds(mesh));
      const auto found = closest_points(sites, points);
      Mesh present = mesh;  // the places of removed faces would be points
      std::erase_if(present.triangles, is_removed);
      for (std::size_t p = 0; p < points.size(); p += 8)
        EXPECT_NEAR(found[p].distance, oracle::brute_force(present, points[p]), 1e-6 * length) << p;
    }
    if (HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Random, EditedMesh, testing::Range(0u, 6u));

TEST(SitesEdit, ClosesAHole) {
  Mesh mesh = test::sphere(2);
  Sites sites(mesh);
  const Triangle hole = mesh.triangles[7];
  sites.edit({.removed_faces = {7}});
  EXPECT_FALSE(sites.closed());
  EXPECT_EQ(choose_sign(sites, SignMethod::automatic).method, SignMethod::none);
  // A lid of three faces around a new vertex.
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  const Vec3 middle = 0.4 * (mesh.positions[hole[0]] + mesh.positions[hole[1]] + mesh.positions[hole[2]]);
  sites.edit({.added_vertices = {middle},
              .added_faces = {{hole[0], hole[1], n}, {hole[1], hole[2], n}, {hole[2], hole[0], n}}});
  EXPECT_TRUE(sites.closed() && sites.orientable());
  const std::vector<Vec3> points{{0, 0, 0}, middle + 0.1 * middle, 0.98 * middle};
  const auto closest = closest_points(sites, points);
  EXPECT_EQ(inside_flags(sites, points, closest, SignMethod::exact), (std::vector<std::uint8_t>{1, 0, 1}));
  EXPECT_NEAR(closest[1].distance, 0.1 * norm(middle), 1e-9);
  EXPECT_EQ(closest[1].type, SiteType::vertex);
  EXPECT_EQ(closest[1].site, n);
}

TEST(SitesEdit, RefitsFollowAnEdit) {
  Mesh mesh = test::torus(20, 12);
  mesh.corner_uvs.clear();
  Sites sites(mesh);
  test::RandomEdits edits(5, {});
  for (int i = 0; i < 10; ++i) {
    const MeshEdit edit = edits.next(mesh);
    apply(mesh, edit);
    sites.edit(edit);
  }
  for (Vec3& p : mesh.positions) p = {p[0] + 0.1 * p[1], 2 * p[1], p[2] - 1};
  sites.refit(mesh.positions);
  std::mt19937 random(1);
  expect_same_answers(sites, Sites(mesh), queries(mesh, random));
}

// A pile of additions at one place, far beyond a leaf, and then their removal.
TEST(SitesEdit, ManyFacesComeAndGo) {
  Mesh mesh = test::sphere(3);
  const Mesh part = test::moved(test::sphere(2), {5, 0, 0});
  Sites sites(mesh);
  MeshEdit add, remove;
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  add.added_vertices = part.positions;
  for (const auto& [a, b, c] : part.triangles) {
    remove.removed_faces.push_back(
        static_cast<std::uint32_t>(mesh.triangles.size() + add.added_faces.size()));
    add.added_faces.push_back({a + n, b + n, c + n});
  }
  std::mt19937 random(1);
  for (const MeshEdit& edit : {add, remove}) {
    apply(mesh, edit);
    sites.edit(edit);
    const Sites fresh(mesh);
    expect_same_data(internals(sites), internals(fresh));
    expect_same_answers(sites, fresh, queries(mesh, random));
  }
}

// Found while writing sites/edit_sites.cpp: the boxes of the tree are those of the frame before the edit.
TEST(SitesEdit, MovesTheMeshFarAway) {
  Mesh mesh = test::sphere(2);
  Sites sites(mesh);
  MeshEdit edit;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    edit.moved_vertices.push_back({v, 1e20 * (mesh.positions[v] + Vec3{1e6, 0, 0})});
  apply(mesh, edit);
  sites.edit(edit);
  std::mt19937 random(1);
  expect_same_answers(sites, Sites(mesh), queries(mesh, random));
}

// The tree is traversed recursively. Faces added in one place make the same leaf deeper every time.
TEST(SitesEdit, AtOnePlaceDoesNotMakeTheTreeDeep) {
  Sites sites(test::ring(56));
  double size = 0.1;
  for (int i = 0; i < 90; ++i) {
    MeshEdit edit;
    for (int k = 0; k < 9; ++k, size *= 0.99) {
      const auto n = static_cast<std::uint32_t>(sites.mesh().positions.size() + edit.added_vertices.size());
      edit.added_vertices.insert(edit.added_vertices.end(), {{size, 0, 0}, {0, size, 0}, {0, 0, size}});
      edit.added_faces.push_back({n, n + 1, n + 2});
    }
    sites.edit(edit);
    ASSERT_LE(tree::depth(internals(sites).tree), tree::kDeepest) << i;
  }
  std::mt19937 random(5);
  expect_same_answers(sites, Sites(sites.mesh()), queries(sites.mesh(), random));
}

}  // namespace
}  // namespace sdm

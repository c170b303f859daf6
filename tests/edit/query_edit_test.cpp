// Queries and maps over time of bodies whose topology changes.
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/sdm.h>
#include <sdm/statistics.h>

#include <cmath>

#include "edit/random_edits.h"
#include "support/made_up_maps.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;

const AtlasOptions kAtlas{.resolution = 64};

Mesh compact(Mesh mesh) {
  std::erase_if(mesh.triangles, is_removed);
  return mesh;
}

void expect_same_answers(ProximityQuery& edited, ProximityQuery& fresh) {
  EXPECT_NEAR(edited.separation().value, fresh.separation().value, 1e-12);
  EXPECT_EQ(edited.colliding(), fresh.colliding());
  const auto &depth = edited.penetration_depth(), &expected = fresh.penetration_depth();
  ASSERT_EQ(depth.has_value(), expected.has_value());
  if (depth) {  // both are bounds
    EXPECT_LE(depth->lower, expected->upper);
    EXPECT_GE(depth->upper, expected->lower);
  }
  const auto contacts = edited.contacts(), all = fresh.contacts();
  EXPECT_EQ(contacts.empty(), all.empty());
  if (!contacts.empty() && !all.empty()) {
    EXPECT_NEAR(contacts[0].depth, all[0].depth, 1e-9);
  }
}

// Every answer and every texel of the map are those of the meshes by themselves.
TEST(QueryEdit, AnswersAreThoseOfTheMeshAlone) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    std::array<Mesh, 2> meshes{ring(8), ring(10, 1, {0.6, 0.1, 0.2})};
    std::array<RandomEdits, 2> edits{RandomEdits(seed, {.defects = false}),
                                     RandomEdits(seed + 10, {.defects = false})};
    ProximityQuery query(Shape(meshes[0], kAtlas), Shape(meshes[1], kAtlas), {.contact_margin = 0.02});
    for (int i = 0; i < 12; ++i) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", edit " << i);
      for (int b = 0; b < 2; ++b) {
        const MeshEdit edit = edits[b].next(meshes[b]);
        apply(meshes[b], edit);
        query.edit(b, edit);
      }
      for (Vec3& p : meshes[0].positions) p[0] += 0.05;
      query.refit(meshes[0].positions, {});
      ProximityQuery fresh(compact(meshes[0]), compact(meshes[1]), {.contact_margin = 0.02});
      expect_same_answers(query, fresh);

      const Surface& surface = query.surface(0);
      const DistanceMap map = compute_map(surface, query.sites(1));
      const oracle::CgalDistance distance(compact(meshes[1]));
      const Sites alone(compact(meshes[1]));
      const std::vector<Vec3> points = surface.sample_points();
      const SignMethod sign = choose_sign(alone, SignMethod::automatic).method;
      const auto inside = inside_flags(alone, points, closest_points(alone, points), sign);
      Disagreements disagreements(1e-6);
      for (std::size_t s = 0; s < points.size(); ++s)
        disagreements.compare(s, map.distance[surface.sample_texels()[s]],
                              distance(points[s]) * (inside[s] ? -1 : 1));
      EXPECT_TRUE(disagreements.none());
    }
  }
}

void expect_equal_contacts(std::span<const Contact> found, std::span<const Contact> expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Contact &a = found[i], &b = expected[i];
    ASSERT_EQ(a.id, b.id);
    ASSERT_EQ(a.patch, b.patch);
    ASSERT_EQ(a.depth, b.depth);
    ASSERT_EQ(a.point1, b.point1);
    ASSERT_EQ(a.point2, b.point2);
    ASSERT_EQ(a.normal, b.normal);
    ASSERT_EQ(a.on, b.on);
  }
}

// Of coarse meshes, whose vertices all have contacts, and of fine ones, with one contact for each part.
TEST(QueryEdit, ContactsAreThoseOfTheEditedMesh) {
  const std::array<Mesh, 4> meshes{cube(0.5), ring(8, 0.5), placed(sphere(2), "scale:0.6"),
                                   placed(sphere(4), "scale:0.6")};
  const Mesh other = moved(sphere(3), {0.4, 0.2, 0.1});
  const ProximityOptions options{.contact_margin = 0.01};
  std::size_t contacts = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Mesh mesh = meshes[seed % 4];
    RandomEdits edits(seed, {.defects = false});
    ProximityQuery query(mesh, other, options), replaced(other, other, options);
    for (int i = 0; i < 6; ++i) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", edit " << i);
      const MeshEdit edit = edits.next(mesh);
      apply(mesh, edit);
      query.edit(0, edit);
      replaced.replace(0, Shape(mesh));
      ProximityQuery fresh(mesh, other, options);
      expect_equal_contacts(query.contacts(), fresh.contacts());
      expect_equal_contacts(replaced.contacts(), fresh.contacts());
      if (HasFatalFailure()) return;
      contacts += fresh.contacts().size();
    }
  }
  EXPECT_GT(contacts, 10000u);
}

TEST(QueryEdit, ARefusedEditChangesNothing) {
  const Mesh mesh = ring(8);
  Shape shared(mesh, kAtlas);
  ProximityQuery query(Shape(mesh, kAtlas), shared);
  const double before = query.separation().value;
  const MeshEdit edit{.removed_faces = {3}};
  EXPECT_THROW(query.edit(1, edit), Error);  // shared
  EXPECT_THROW(query.edit(0, {.removed_faces = {3, 3}}), Error);
  EXPECT_EQ(query.surface(0).mesh().triangles, mesh.triangles);
  EXPECT_EQ(query.sites(0).mesh().triangles, mesh.triangles);
  EXPECT_EQ(query.separation().value, before);
  query.edit(0, edit);
  EXPECT_TRUE(is_removed(query.sites(0).mesh().triangles[3]));
}

TEST(QueryEdit, AReplacedBodyKeepsItsPose) {
  ProximityQuery query(ring(8), sphere(2));
  query.set_pose(1, Transform::translation({5, 0, 0}));
  query.replace(1, Shape(cube()));
  ProximityQuery before(ring(8), moved(cube(), {5, 0, 0}));
  EXPECT_NEAR(query.separation().value, before.separation().value, 1e-12);
  query.replace(0, Shape(sphere(2)));
  ProximityQuery fresh(sphere(2), moved(cube(), {5, 0, 0}));
  EXPECT_NEAR(query.separation().value, fresh.separation().value, 1e-12);
}

// Of what stays to the bit, and of nothing else.
TEST(TemporalEdit, MapsOverTimeAreThoseOfFixedTopologyWhereFacesStay) {
  const Mesh mesh = ring(10);
  const auto field = [](int t) { return [t](const Vec3& p) { return p[0] + std::cos(t * p[1]) * p[2]; }; };
  Surface fixed(mesh, kAtlas), edited(mesh, kAtlas);
  const std::vector<std::uint32_t> first(edited.texel_faces().begin(), edited.texel_faces().end());
  TemporalMaps expected, maps;
  RandomEdits edits(5, {.moves = false, .defects = false});
  for (int t = 0; t < 12; ++t) {
    if (t > 0 && t % 2 == 0) {
      const std::vector<std::uint32_t> before(edited.texel_faces().begin(), edited.texel_faces().end());
      MeshEdit edit = edits.next(edited.mesh());
      if (t == 4) edit = {.added_faces = std::vector<Triangle>(mesh.triangles.begin(), mesh.triangles.end())};
      if (t == 6)
        edit = {.removed_faces = {0, 1, 2, 3, 4, 5}, .added_faces = {mesh.triangles[3], mesh.triangles[4]}};
      if (t == 6)
        std::erase_if(edit.removed_faces,
                      [&](std::uint32_t f) { return is_removed(edited.mesh().triangles[f]); });
      for (const auto& [face, triangle] : edit.reconnected_faces)  // without the offset of copies
        for (int k = 0; k < 3; ++k)
          if (triangle[k] >= edited.mesh().positions.size())
            edit.added_vertices[triangle[k] - edited.mesh().positions.size()] =
                edited.mesh().positions[edited.mesh().triangles[face][k]];
      edited.edit(edit);
      maps.follow_edit(before, edited);
    }
    expected.add(map_of(fixed, field(t)));
    maps.add(map_of(edited, field(t)));
  }
  EXPECT_GT(edited.rows(), fixed.rows());
  ASSERT_EQ(maps.least().size(), edited.texel_faces().size());
  const std::vector<float> mean = maps.mean(), expected_mean = expected.mean();
  std::size_t stay = 0, gone = 0;
  for (std::size_t i = 0; i < maps.least().size(); ++i) {
    const bool stays = i < first.size() && first[i] != kNone && edited.map_faces()[i] == first[i];
    ASSERT_EQ(std::isnan(maps.least()[i]), !stays);
    ASSERT_EQ(std::isnan(maps.largest()[i]), !stays);
    ASSERT_EQ(std::isnan(mean[i]), !stays);
    gone += !stays && i < first.size() && first[i] != kNone;
    if (!stays) continue;
    ++stay;
    ASSERT_EQ(maps.least()[i], expected.least()[i]);
    ASSERT_EQ(maps.largest()[i], expected.largest()[i]);
    ASSERT_EQ(mean[i], expected_mean[i]);
  }
  EXPECT_GT(stay, 1000u);
  EXPECT_GT(gone, 20u);
}

TEST(TemporalEdit, RejectsAnotherSurface) {
  Surface surface(ring(10), kAtlas);
  TemporalMaps maps;
  maps.follow_edit({}, surface);  // nothing to follow
  maps.add(map_of(surface, [](const Vec3&) { return 1; }));
  const std::vector<std::uint32_t> few(10);
  EXPECT_THROW(maps.follow_edit(few, surface), Error);
  EXPECT_THROW(maps.follow_edit(surface.texel_faces(), Surface(ring(10), {.resolution = 128})), Error);
}

}  // namespace
}  // namespace sdm

// Tests of the parts of the simulations against their definitions.
#include <gtest/gtest.h>
#include <sdm/map_files.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "scenes/box_mesh.h"
#include "scenes/contacts.h"
#include "scenes/reduce_mesh.h"
#include "scenes/rotation.h"
#include "scenes/skeleton.h"
#include "scenes/soft_body.h"
#include "scenes/spatial_hash.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::scenes {
namespace {

using namespace test;

std::mt19937 random_bits;

Vec3 random_point(double lo = -1, double hi = 1) {
  std::uniform_real_distribution<double> number(lo, hi);
  return {number(random_bits), number(random_bits), number(random_bits)};
}
Matrix random_rotation() {
  return rotation_about(normalized(random_point()), random_point(0, std::numbers::pi)[0]);
}

void expect_near(const Matrix& a, const Matrix& b, double tolerance) {
  for (int k = 0; k < 3; ++k) EXPECT_LE(norm(a[k] - b[k]), tolerance);
}

constexpr Matrix kIdentity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

TEST(Rotation, TurnsAboutItsAxisRightHanded) {
  EXPECT_LE(norm(rotation_about({0, 0, 1}, std::numbers::pi / 2) * Vec3{1, 0, 2} - Vec3{0, 1, 2}), 1e-15);
  for (int i = 0; i < 100; ++i) {
    const Vec3 axis = normalized(random_point());
    expect_near(rotation_about(axis, 0.7) * rotation_about(axis, -0.7), kIdentity, 1e-14);
    EXPECT_LE(norm(rotation_about(axis, 1.3) * axis - axis), 1e-14);
  }
}

TEST(Rotation, IsTheRotationalPartOfADeformation) {
  for (int i = 0; i < 200; ++i) {
    const Matrix r = random_rotation(), q = random_rotation();
    // S = QᵀDQ is symmetric and positive: A = RS.
    const Vec3 d = random_point(0.3, 2);
    Matrix s{};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int k = 0; k < 3; ++k) s[b][a] += q[a][k] * d[k] * q[b][k];
    Matrix part = random_rotation();
    for (int call = 0; call < 20; ++call)
      part = rotation_part(r * s, part);  // each starts from the previous one
    expect_near(part, r, 1e-6);
  }
}

TEST(Rotation, IsARotationForAnyMatrix) {
  for (const Matrix& a :
       {Matrix{}, Matrix{{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, Matrix{{{1, 2, 3}, {1, 2, 3}, {0, 0, 0}}},
        Matrix{{{1e9, 0, 0}, {0, 0, 0}, {0, 0, 1e-9}}}}) {
    const Matrix r = rotation_part(a, random_rotation());
    EXPECT_NEAR(dot(cross(r[0], r[1]), r[2]), 1, 1e-12);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(norm(r[k]), 1, 1e-12);
  }
}

TEST(SpatialHash, FindsAllNearPoints) {
  std::vector<Vec3> points(500);
  for (Vec3& p : points) p = random_point();
  SpatialHash hash(0.2);
  hash.fill(points);
  for (const Vec3& p : points) {
    std::set<std::uint32_t> near;
    hash.for_each_near(p, [&](std::uint32_t j) { near.insert(j); });
    EXPECT_LT(near.size(), points.size() / 2);
    for (std::uint32_t j = 0; j < points.size(); ++j)
      EXPECT_TRUE(near.contains(j) || norm(points[j] - p) > 0.2);
  }
}

TEST(SceneContacts, AreThePointsWithinTheMarginOfASolid) {
  const Sites box(box_mesh({{-1, -1, -1}, {1, 1, 1}}));
  const std::vector<Vec3> points{{0.2, 0.3, 0.9}, {0.2, 0.3, 1.05},  {0.2, 0.3, 1.15},
                                 {5, 0, 0},       {1.03, 1.04, 0.5}, {0, 0, 1}};
  const std::vector<VertexContact> contacts = find_contacts(points, box, 0.1);
  ASSERT_EQ(contacts.size(), 3u);
  EXPECT_EQ(contacts[0].point, 0u);
  EXPECT_EQ(contacts[0].normal, (Vec3{0, 0, 1}));
  EXPECT_NEAR(contacts[0].depth, 0.2, 1e-12);
  EXPECT_EQ(contacts[1].normal, (Vec3{0, 0, 1}));
  EXPECT_NEAR(contacts[1].depth, 0.05, 1e-12);
  EXPECT_LE(norm(contacts[2].normal - Vec3{0.6, 0.8, 0}), 1e-12);
  EXPECT_NEAR(contacts[2].depth, 0.05, 1e-12);
  for (const VertexContact& c : contacts) {
    Vec3 closest = points[c.point] - (0.1 - c.depth) * c.normal, on_face{};
    for (int k = 0; k < 3; ++k) on_face += c.weights[k] * box.mesh().positions[c.face[k]];
    EXPECT_LE(norm(closest - on_face), 1e-12);
  }
}

TEST(SoftBody, MovesRigidlyWithoutContact) {
  const Mesh mesh = torus(24, 12);
  SoftBody body(mesh, {.stiffness = 0.2, .cluster_radius = 1}, {1, 2, 3}, {0, 0, 2});
  for (int i = 0; i < 100; ++i) {
    body.begin_step(0.001);
    body.match_shapes();
    body.end_step(0.001);
  }
  const Matrix turn = rotation_about({0, 0, 1}, 0.2);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_LE(norm(body.positions()[v] - (turn * mesh.positions[v] + Vec3{0.1, 0.2, 0.3})), 1e-3);
}

TEST(SoftBody, PullsHaveNoNetForceOrTorqueAndRestoreTheShape) {
  const Mesh mesh = torus(24, 12);
  SoftBody body(mesh, {.stiffness = 0.5, .cluster_radius = 1}, {}, {});
  std::vector<Vec3> pushed;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    body.move(v, random_point(-0.1, 0.1));
    pushed.push_back(body.positions()[v]);
  }
  const auto roughness = [&] {
    double squared = 0;
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const auto length = [&](std::span<const Vec3> p) { return norm(p[t[(k + 1) % 3]] - p[t[k]]); };
        squared += std::pow(length(body.positions()) - length(mesh.positions), 2);
      }
    return squared;
  };
  const double before = roughness();
  body.match_shapes();
  Vec3 force{}, torque{};
  for (std::size_t v = 0; v < pushed.size(); ++v) {
    const Vec3 pull = body.positions()[v] - pushed[v];
    force += pull;
    torque += cross(pushed[v], pull);
  }
  EXPECT_LE(norm(force), 1e-10);
  EXPECT_LE(norm(torque), 1e-4);  // up to the accuracy of the rotations
  for (int i = 0; i < 20; ++i) body.match_shapes();
  EXPECT_LT(roughness(), 0.01 * before);
}

// A cluster that reached across the gap would keep two strips at their distance.
TEST(SoftBody, ClustersFollowTheSurface) {
  Mesh strips;
  for (const double y : {0.0, 0.1}) {
    Mesh strip;
    for (int i = 0; i <= 20; ++i)
      for (const double z : {0.0, 0.05}) strip.positions.push_back({0.05 * i, y, z});
    for (std::uint32_t i = 0; i < 40; i += 2) {
      strip.triangles.push_back({i, i + 2, i + 3});
      strip.triangles.push_back({i, i + 3, i + 1});
    }
    strips = joined(strips, strip);
  }
  SoftBody body(strips, {.stiffness = 1, .cluster_radius = 0.3, .clusters = 10}, {}, {});
  const auto half = static_cast<std::uint32_t>(strips.positions.size() / 2);
  for (std::uint32_t v = 0; v < half; ++v) body.move(v, {0, -0.5, 0});
  for (int i = 0; i < 10; ++i) body.match_shapes();
  for (std::uint32_t v = 0; v < half; ++v)
    EXPECT_LE(norm(body.positions()[v] - strips.positions[v] - Vec3{0, -0.5, 0}), 1e-9);
}

TEST(Skeleton, BonesMoveTheirChildrenAndTheSkin) {
  // Two bones of length 1 along x; the second rotates by a right angle.
  const Skeleton arm{{{0, {0, 0, 0}}, {0, {1, 0, 0}}},
                     {{0, {0, 0, 0}, {0.9, 0, 0}, 0.1, 0.1}, {1, {1.1, 0, 0}, {2, 0, 0}, 0.1, 0.2}}};
  EXPECT_NEAR(skin_distance(arm, {0.3, 0, 0.4}), 0.3, 1e-6);
  EXPECT_LT(skin_distance(arm, {1.9, 0.1, 0}), 0);
  const Matrix turn = rotation_about({0, 0, 1}, std::numbers::pi / 2);
  const std::vector<Vec3> points{{0.3, 0.1, 0}, {1.8, 0, 0.15}};
  std::vector<Vec3> moved;
  Skin(arm, points).move(pose(arm, std::array{kIdentity, turn}), moved);
  EXPECT_LE(norm(moved[0] - points[0]), 1e-9);
  EXPECT_LE(norm(moved[1] - Vec3{1, 0.8, 0.15}), 1e-9);
  Skin(arm, points).move(pose(arm, std::array{turn, kIdentity}), moved);
  EXPECT_LE(norm(moved[1] - Vec3{0, 1.8, 0.15}), 1e-9);
}

TEST(ReduceMesh, KeepsTheShapeAndStaysClosed) {
  const Mesh mesh = test::load("bunny.obj"), reduced = reduce_mesh(mesh, 2000);
  const MeshInfo info = inspect(reduced), full = inspect(mesh);
  EXPECT_NEAR(static_cast<double>(info.triangles), 2000, 20);
  EXPECT_EQ(info.unused_vertices + info.duplicate_faces, 0u);
  EXPECT_EQ(info.closed, full.closed);
  EXPECT_NEAR(info.area, full.area, 0.03 * full.area);
}

TEST(ReduceMesh, KeepsMeshesOfFewerTriangles) {
  const Mesh mesh = box_mesh({{0, 0, 0}, {1, 2, 3}});
  EXPECT_EQ(reduce_mesh(mesh, 2000).triangles.size(), mesh.triangles.size());
}

}  // namespace
}  // namespace sdm::scenes

// The contact patches of convex solids that overlap.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "support/allocations.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr std::uint64_t kExit = ProximityQuery::kExitContact;

std::vector<Contact> patch_of(ProximityQuery& query) {
  std::vector<Contact> patch;
  for (const Contact& c : query.separating_contacts())
    if (c.id != kExit) patch.push_back(c);
  return patch;
}

std::set<std::uint64_t> ids_of(ProximityQuery& query) {
  std::set<std::uint64_t> ids;
  for (const Contact& c : query.separating_contacts()) ids.insert(c.id);
  return ids;
}

Mesh prism(int sides, double half) {
  Mesh mesh;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / sides;
    for (const double x : {-half, half}) mesh.positions.push_back({x, std::cos(angle), std::sin(angle)});
  }
  for (std::uint32_t v = 2; v < mesh.positions.size(); ++v) mesh.triangles.push_back({v - 2, v - 1, v});
  return convex_hull(mesh);
}

Mesh ellipsoid(int level) {
  Mesh mesh = sphere(level);
  for (Vec3& p : mesh.positions) p = {p[0], 0.7 * p[1], 0.5 * p[2]};
  return convex_hull(mesh);
}

Transform tilted(double degrees, const Vec3& axis) {
  const double half = degrees * std::acos(-1.0) / 360;
  const Vec3 u = std::sin(half) * normalized(axis);
  return Transform::quaternion({std::cos(half), u[0], u[1], u[2]});
}

// A box on a plate, tilted by little: a contact below each of its corners, with its own depth.
TEST(ConvexPatch, OfATiltedBoxHasTheDepthOfEachCorner) {
  const Mesh small = box({0.5, 0.4, 0.3}), plate = box({3, 3, 1});
  ProximityQuery query(small, plate);
  query.set_pose(0, Transform::translation({0.3, 0.2, 1.28}) * tilted(1, {0.3, 1, 0}));
  std::map<std::uint64_t, double> depth;
  for (const Contact& c : patch_of(query)) {
    EXPECT_NEAR(c.normal[2], 1, 1e-12);
    EXPECT_NEAR(c.point2[2], 1, 1e-12);
    EXPECT_NEAR(c.depth, 1 - c.point1[2], 1e-9);
    depth[c.id] = c.depth;
  }
  ASSERT_EQ(depth.size(), 4u);
  for (const Vec3& p : small.positions) {
    const double below = 1 - query.pose(0)(p)[2];
    const auto is_below = [&](const auto& of) { return std::abs(of.second - below) < 1e-9; };
    EXPECT_EQ(std::ranges::any_of(depth, is_below), below > 0);
  }
  const double value = query.separating_translation().value;
  EXPECT_NEAR(query.separating_contacts()[0].depth, value, 1e-9);
  EXPECT_EQ(query.separating_contacts()[0].id, kExit);
}

// Corners that are out of the plate, by more than the margin, have no contact.
TEST(ConvexPatch, LeavesOutCornersOutside) {
  for (const double margin : {0.0, 0.1}) {
    ProximityQuery query(box({0.5, 0.4, 0.3}), box({3, 3, 1}), {.contact_margin = margin});
    query.set_pose(0, Transform::translation({0.3, 0.2, 1.305}) * tilted(1.5, {0, 1, 0}));
    EXPECT_EQ(patch_of(query).size(), margin > 0 ? 4u : 2u);
  }
}

// Beyond 3 degrees a box touches by an edge or a corner.
TEST(ConvexPatch, IsOfAnEdgeOrACorner) {
  ProximityQuery query(box({0.5, 0.4, 0.3}), box({3, 3, 1}));
  query.set_pose(0, Transform::translation({0.3, 0.2, 1.4}) * tilted(30, {0, 1, 0}));
  EXPECT_EQ(patch_of(query).size(), 2u);
  query.set_pose(0, Transform::translation({0.3, 0.2, 1.6}) * tilted(30, {0, 1, 0}) * tilted(30, {1, 0, 0}));
  ASSERT_EQ(patch_of(query).size(), 1u);
  EXPECT_NEAR(patch_of(query)[0].depth, query.separating_translation().value, 1e-9);
}

// Two edges that cross have one contact.
TEST(ConvexPatch, IsOfEdgesThatCross) {
  ProximityQuery query(box({2, 1, 1}), box({1, 2, 1}));
  query.set_pose(0, Transform::translation({0.1, 0.2, 2.7}) * tilted(45, {1, 0, 0}));
  query.set_pose(1, tilted(45, {0, 1, 0}));
  const std::vector<Contact> patch = patch_of(query);
  ASSERT_EQ(patch.size(), 1u);
  const double edge = std::sqrt(2.0);
  EXPECT_NEAR(patch[0].depth, 2 * edge - 2.7, 1e-9);
  EXPECT_NEAR(patch[0].point1[2], 2.7 - edge, 1e-9);
  EXPECT_NEAR(patch[0].point2[2], edge, 1e-9);
  for (const Vec3& p : {patch[0].point1, patch[0].point2}) {
    EXPECT_NEAR(p[0], 0, 1e-9);
    EXPECT_NEAR(p[1], 0.2, 1e-9);
  }
}

// A box that slides and sinks keeps the names of its contacts.
TEST(ConvexPatch, KeepsIds) {
  ProximityQuery query(box({0.5, 0.4, 0.3}), box({1, 1, 1}));
  std::set<std::uint64_t> first;
  for (int step = 0; step < 50; ++step) {
    const double along = 0.002 * step;
    query.set_pose(0, Transform::translation({0.7 + along, 0.2 - along, 1.28 - 0.1 * along}) *
                          tilted(20 + step, {0, 0, 1}));
    const std::set<std::uint64_t> ids = ids_of(query);
    EXPECT_GE(ids.size(), 4u);
    if (step == 0) first = ids;
    // Corners of the box that stay over the plate, or out of it.
    if (step < 3) {
      EXPECT_EQ(ids, first) << step;
    }
  }
}

TEST(ConvexPatch, IsReversedWithTheBodies) {
  const Shape a(prism(7, 0.4)), b(box({0.5, 0.7, 0.9}));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-0.6, 0.6);
  for (int i = 0; i < 100; ++i) {
    const Transform pose = Transform::translation({at(random), at(random), at(random)}) *
                           tilted(300 * at(random), {at(random), at(random), at(random)});
    ProximityQuery query(a, b), exchanged(b, a);
    query.set_pose(0, pose);
    exchanged.set_pose(1, pose);
    ASSERT_TRUE(query.colliding());
    EXPECT_NEAR(query.separating_translation().value, exchanged.separating_translation().value, 1e-9);
    // Of two directions that are as short, either may be the first.
    if (norm(query.separating_translation().translation + exchanged.separating_translation().translation) >
        1e-6)
      continue;
    const std::vector<Contact> found = patch_of(query), reversed = patch_of(exchanged);
    ASSERT_EQ(found.size(), reversed.size()) << i;
    for (const Contact& c : found)
      EXPECT_TRUE(std::ranges::any_of(reversed, [&](const Contact& r) {
        return norm(c.point1 - r.point2) < 1e-6 && norm(c.point2 - r.point1) < 1e-6 &&
               norm(c.normal + r.normal) < 1e-6 && std::abs(c.depth - r.depth) < 1e-6;
      })) << i;
  }
}

// The points of a contact are above each other along the translation, on the sides that face each other.
void expect_patch(ProximityQuery& query) {
  const SeparatingTranslation& out = query.separating_translation();
  ASSERT_EQ(out.certainty, Certainty::exact);
  const Vec3 normal = normalized(out.translation);
  const std::span<const Contact> all = query.separating_contacts();
  ASSERT_GE(all.size(), 2u);
  EXPECT_EQ(all[0].id, kExit);
  EXPECT_NEAR(all[0].depth, out.value, 2e-6);
  EXPECT_EQ(all[0].depth, std::ranges::max(all.subspan(1), {}, &Contact::depth).depth);
  std::set<std::uint64_t> ids;
  for (const Contact& c : all) {
    EXPECT_TRUE(ids.insert(c.id).second);
    EXPECT_TRUE((c.id >> 62 & 1) != 0) << "of a patch, not of contacts()";
    EXPECT_LE(norm(c.normal - normal), 1e-12);
    EXPECT_LE(c.depth, (1 + 1e-15) * out.upper);
    EXPECT_LE(norm(c.point2 - c.point1 - dot(normal, c.point2 - c.point1) * normal), 1e-5);
    for (int body = 0; body < 2; ++body) {
      const Mesh& mesh = query.sites(body).mesh();
      const Triangle& corners = mesh.triangles[c.on[body].face];
      Vec3 p{};
      for (int k = 0; k < 3; ++k) p += c.on[body].barycentric[k] * mesh.positions[corners[k]];
      EXPECT_LE(norm(query.pose(body)(p) - (body == 0 ? c.point1 : c.point2)), 1e-12);
      EXPECT_NEAR(c.on[body].barycentric[0] + c.on[body].barycentric[1] + c.on[body].barycentric[2], 1,
                  1e-12);
    }
  }
}

TEST(ConvexPatch, OfRandomPoses) {
  const std::vector<Shape> shapes{Shape(cube()),      Shape(box({1, 0.2, 0.05})), Shape(tetrahedron()),
                                  Shape(prism(6, 1)), Shape(ellipsoid(1)),        Shape(ellipsoid(3))};
  std::mt19937 random(38);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> along(0, 1.2), scale(0.5, 2);
  std::size_t overlapping = 0, contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    ProximityQuery query(shapes[i % shapes.size()], shapes[i / shapes.size() % shapes.size()]);
    const Vec3 direction = normalized(Vec3{normal(random), normal(random), normal(random)});
    query.set_pose(
        0, Transform::translation(along(random) * direction) * Transform::scaling(scale(random)) *
               Transform::quaternion({normal(random), normal(random), normal(random), normal(random)}));
    if (!query.colliding()) continue;
    ++overlapping;
    expect_patch(query);
    if (HasFatalFailure()) return;
    contacts += query.separating_contacts().size();
  }
  EXPECT_GT(overlapping, 1000u);
  EXPECT_LT(contacts, 6 * overlapping) << "few";
}

// Whatever the direction, it is the same each time, and so are the contacts.
TEST(ConvexPatch, OfBodiesInOnePlace) {
  for (const Mesh& mesh : {cube(), box({1, 0.5, 0.2}), tetrahedron(), prism(6, 1), ellipsoid(2)}) {
    ProximityQuery query(mesh, mesh), again(mesh, mesh);
    expect_patch(query);
    const std::span<const Contact> a = query.separating_contacts(), b = again.separating_contacts();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].id, b[i].id);
      EXPECT_EQ(a[i].point1, b[i].point1);
      EXPECT_EQ(a[i].normal, b[i].normal);
    }
  }
}

// A body that was refitted has the patch of one that was made so.
TEST(ConvexPatch, AfterARefit) {
  const Mesh before = box({1, 1, 1}), after = box({0.5, 0.4, 0.3}), plate = box({3, 3, 1});
  ProximityQuery refitted(before, plate), made(after, plate);
  refitted.refit(after.positions, {});
  for (ProximityQuery* query : {&refitted, &made})
    query->set_pose(0, Transform::translation({0.3, 0.2, 1.28}) * tilted(1, {0.3, 1, 0}));
  ASSERT_EQ(refitted.separating_contacts().size(), made.separating_contacts().size());
  for (std::size_t i = 0; i < made.separating_contacts().size(); ++i) {
    EXPECT_EQ(refitted.separating_contacts()[i].id, made.separating_contacts()[i].id);
    EXPECT_EQ(refitted.separating_contacts()[i].point1, made.separating_contacts()[i].point1);
  }
}

TEST(ConvexPatch, AllocatesNothingAfterTheFirstPoses) {
  const ThreadLimit alone(1);  // threads that join later allocate memory of their own
  for (const Mesh& mesh : {cube(), ellipsoid(1), ellipsoid(3)}) {
    ProximityQuery query(mesh, mesh, {.ignore_internal_edges = true});
    const auto taken = [&] {
      const std::size_t before = allocations();
      for (int i = 0; i < 20; ++i) {
        query.set_pose(0,
                       Transform::translation({0.3 + 0.01 * i, 0.02 * i, -0.2}) * tilted(10 * i, {1, 2, 3}));
        (void)query.separating_contacts(2);
      }
      return allocations() - before;
    };
    EXPECT_GT(taken(), 0u);
    EXPECT_EQ(taken(), 0u);
  }
}

}  // namespace
}  // namespace sdm::test

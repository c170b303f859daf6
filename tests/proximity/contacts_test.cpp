// Contacts against known ones, and against signed distances by brute force.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "geometry/vec.h"
#include "scenes/blocks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using scenes::Blocks, scenes::union_of;

Mesh beam(const Vec3& half, const Vec3& centre) {
  Mesh mesh = cube();
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = half[k] * p[k] + centre[k];
  return mesh;
}

std::vector<Contact> contacts_of(const Mesh& a, const Mesh& b, double margin) {
  ProximityQuery query(a, b, {.contact_margin = margin});
  return {query.contacts().begin(), query.contacts().end()};
}

/// Whether some contact has its first point here.
bool has_point(const std::vector<Contact>& contacts, const Vec3& point) {
  return std::ranges::any_of(contacts, [&](const Contact& c) { return norm(c.point1 - point) < 1e-6; });
}

// A plate carries a box at its four corners: without, at and beyond contact.
TEST(Contacts, OfABoxOnAPlateAreItsCorners) {
  const Mesh plate = beam({5, 5, 0.5}, {0, 0, -0.5});
  for (const double height : {0.01, 0.0, -0.01}) {
    SCOPED_TRACE(height);
    const std::vector<Contact> contacts = contacts_of(beam({1, 2, 1}, {0.3, 0.1, 1 + height}), plate, 0.02);
    ASSERT_EQ(contacts.size(), 4u);
    for (const double x : {-1, 1})
      for (const double y : {-2, 2}) EXPECT_TRUE(has_point(contacts, {0.3 + x, 0.1 + y, height}));
    for (const Contact& c : contacts) {
      EXPECT_NEAR(c.depth, -height, 1e-9);
      EXPECT_NEAR(c.normal[2], 1, 1e-9);
      EXPECT_EQ(c.patch, 0u);
      EXPECT_NEAR(c.point2[2], 0, 1e-9);
    }
  }
}

// However slender a body is, it stands on the corners of its feet, and not on the deepest one alone.
TEST(Contacts, OfSlenderBodiesAreTheirCorners) {
  Blocks comb{{{0, 0, 1}, {27, 1, 2}}};
  for (int foot = 0; foot < 14; ++foot) comb.push_back({{2.0 * foot, 0, 0}, {2.0 * foot + 1, 1, 1}});
  struct Case {
    Mesh mesh;
    std::size_t corners;
  };
  const Case cases[]{{union_of({{{0, 0, 0}, {1, 1, 25}}}), 4},
                     {union_of({{{0, 0, 0}, {1, 1, 100}}}), 4},
                     {union_of({{{0, 0, 0}, {0.1, 100, 100}}}), 4},
                     {union_of(comb), 56}};
  for (const auto& [mesh, corners] : cases) {
    ProximityQuery query(mesh, beam({200, 200, 1}, {0, 0, -1}));
    std::set<std::uint64_t> ids;
    for (const double tilt : {0.0, 1e-5, -1e-5}) {  // degrees
      query.set_pose(0, Transform::translation({0, 0, -0.01}) * Transform::rotation({tilt, 0, 0}));
      std::size_t found = 0;
      for (const Contact& c : query.contacts()) {
        EXPECT_NEAR(c.point1[2], -0.01, 1e-4);
        EXPECT_NEAR(c.depth, -c.point1[2], 1e-9);
        EXPECT_NEAR(c.normal[2], 1, 1e-9);
        ids.insert(c.id);
        ++found;
      }
      EXPECT_EQ(found, corners);
    }
    EXPECT_EQ(ids.size(), corners) << "of all frames";
  }
}

// A slender cylinder of many sides stands on points all around, of which there are few.
TEST(Contacts, OfASlenderCylinderAreAroundItsAxis) {
  constexpr std::uint32_t kSides = 64;
  Mesh post;
  post.positions = {{0, 0, 0}, {0, 0, 25}};
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kSides;
    for (const double z : {0, 25})
      post.positions.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle), z});
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % kSides);
    for (const Triangle& t :
         {Triangle{0, b, a}, Triangle{1, a + 1, b + 1}, Triangle{a, b, b + 1}, Triangle{a, b + 1, a + 1}})
      post.triangles.push_back(t);
  }
  ProximityQuery query(post, beam({5, 5, 1}, {0, 0, -1}));
  query.set_pose(0, Transform::translation({0, 0, -0.01}) * Transform::rotation({0.3, 0.2, 0}));
  EXPECT_LE(query.contacts().size(), 32u);
  for (int i = 0; i < 16; ++i) {
    const Vec3 u{std::cos(0.4 * i), std::sin(0.4 * i), 0};
    double farthest = 0;
    for (const Contact& c : query.contacts()) farthest = std::max(farthest, dot(u, c.point1));
    EXPECT_GT(farthest, 0.45) << i;
  }
}

// Neither of two beams that cross has a corner in the other: the contacts are those of their edges, at the
// corners of the square where they meet, of both beams.
TEST(Contacts, OfBeamsThatCross) {
  const Mesh lower = beam({5, 1, 1}, {0, 0, -1});
  for (const double height : {0.01, -0.01}) {
    SCOPED_TRACE(height);
    const std::vector<Contact> contacts = contacts_of(beam({0.5, 5, 1}, {0.2, 0, 1 + height}), lower, 0.02);
    ASSERT_EQ(contacts.size(), 8u);
    for (const double x : {-0.5, 0.5})
      for (const double y : {-1, 1}) EXPECT_TRUE(has_point(contacts, {0.2 + x, y, height}));
    std::set<std::uint64_t> ids;
    for (const Contact& c : contacts) {
      EXPECT_TRUE(ids.insert(c.id).second);
      EXPECT_NEAR(c.depth, -height, 1e-9);
      EXPECT_NEAR(c.normal[2], 1, 1e-9);
    }
  }
}

// One edge over two posts of one body touches each of them; both posts are narrower than the plank.
TEST(Contacts, OfAPlankOnTwoPosts) {
  const Mesh posts = joined(beam({0.3, 3, 1}, {-3, 0, -1}), beam({0.3, 3, 1}, {3, 0, -1}));
  const std::vector<Contact> contacts = contacts_of(beam({5, 1, 0.1}, {0, 0, 0.105}), posts, 0.01);
  ASSERT_EQ(contacts.size(), 16u);
  for (const double x : {-3, 3})
    for (const double side : {-0.3, 0.3})
      for (const double y : {-1, 1}) EXPECT_TRUE(has_point(contacts, {x + side, y, 0.005}));
  // The corner of a plank on one post does not hide its contact with the other one.
  EXPECT_TRUE(has_point(contacts_of(beam({5, 1, 0.1}, {2, 0, 0.105}), posts, 0.01), {3.3, 1, 0.005}));
}

// Flush with each other: the sides, which touch, cannot push a corner.
TEST(Contacts, OfAlignedBoxesPointUpwards) {
  for (const double height : {0.01, 0.0, -0.01}) {
    SCOPED_TRACE(height);
    const std::vector<Contact> contacts = contacts_of(cube(0.5), moved(cube(0.5), {0, 0, -1 - height}), 0.02);
    EXPECT_GE(contacts.size(), 4u);
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) EXPECT_TRUE(has_point(contacts, {x, y, -0.5}));
    for (const Contact& c : contacts) {
      EXPECT_NEAR(c.normal[2], 1, 1e-6);
      EXPECT_NEAR(c.depth, -height, 1e-9);
    }
  }
}

// The edges inside a flat face have no contacts.
TEST(Contacts, DoNotDependOnTheDivisionOfFlatFaces) {
  const Mesh plate = beam({5, 5, 0.5}, {0, 0, -0.5}), ball = moved(sphere(3), {0.3, 0.1, 0.99});
  const auto on_plate = [&](const std::vector<Contact>& contacts) {
    return std::ranges::count_if(contacts, [](const Contact& c) { return (c.id >> 63) == 1; });
  };
  EXPECT_EQ(on_plate(contacts_of(ball, plate, 0.01)), 0);
}

double signed_distance(const Mesh& solid, const Vec3& p) {
  const double distance = oracle::brute_force(solid, p);
  return oracle::winding_number(solid, p) != 0 ? -distance : distance;
}

/// Whether the faces beside an edge lie in a plane.
bool flat(const Mesh& mesh, std::uint32_t v, std::uint32_t w) {
  std::vector<Vec3> normals;
  for (const Triangle& t : mesh.triangles)
    if (std::ranges::count(t, v) + std::ranges::count(t, w) == 2)
      normals.push_back(normalized(
          cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]])));
  return normals.size() == 2 && norm(normals[0] - normals[1]) < 1e-6;
}

// All vertices in contact are near a contact that is at least as deep: in a part, or in a region that is not
// larger than it is deep. Those of coarse meshes are contacts. All parts of edges in contact between their
// ends have one.
TEST(Contacts, CoverAllVerticesAndEdges) {
  const std::vector<Mesh> meshes{cube(0.5), tetrahedron(), placed(sphere(1), "scale:0.6"),
                                 placed(sphere(3), "scale:0.6"), beam({0.8, 0.1, 0.1}, {})};
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-0.7, 0.7);
  std::size_t vertices = 0, parts = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Mesh& a = meshes[static_cast<std::size_t>(trial) % meshes.size()];
    Mesh b = meshes[static_cast<std::size_t>(trial / 5) % meshes.size()];
    transform(b.positions,
              Transform::translation({offset(random), offset(random), offset(random)}) *
                  Transform::quaternion({normal(random), normal(random), normal(random), normal(random)}));
    const double margin = trial % 2 == 0 ? 0.05 : 0;
    const std::vector<Contact> contacts = contacts_of(a, b, margin);
    SCOPED_TRACE(trial);
    for (const Contact& c : contacts) {
      const bool on_b = c.id >> 63 != 0;
      const double d = signed_distance(on_b ? a : b, on_b ? c.point2 : c.point1);
      EXPECT_GE(c.depth, -d - 1e-6);  // deeper if the closest face cannot push it
      EXPECT_LE(d, margin + 1e-6);
      EXPECT_NEAR(norm(c.point2 - c.point1), std::abs(c.depth), 1e-6);
    }
    for (const int body : {0, 1}) {
      const Mesh &on = body == 0 ? a : b, &other = body == 0 ? b : a;
      const auto point = [&](const Contact& c) { return body == 0 ? c.point1 : c.point2; };
      const double part = diagonal(bounds(on)) / 16;
      std::map<std::uint32_t, double> distance;
      for (std::uint32_t v = 0; v < on.positions.size(); ++v) {
        const Vec3& p = on.positions[v];
        distance[v] = signed_distance(other, p);
        if (!(distance[v] <= margin - 1e-6)) continue;
        ++vertices;
        EXPECT_TRUE(std::ranges::any_of(contacts, [&](const Contact& c) {
          const double reach = std::max(on.triangles.size() > 100 ? part : 0, c.depth);
          return c.id >> 63 == static_cast<std::uint64_t>(body) && -c.depth <= distance[v] + 1e-6 &&
                 norm(point(c) - p) <= reach + 1e-6;
        }));
      }
      const Sites sites(on);
      if (on.triangles.size() > 100 || other.triangles.size() > 100) continue;  // the oracle is slow
      for (const auto& [v, w] : sites.edges()) {
        if (flat(on, v, w)) continue;
        constexpr int kSteps = 100;
        const Vec3 from = on.positions[v], along = on.positions[w] - from;
        if (norm(along) < diagonal(bounds(on)) / 8 && (distance[v] <= margin || distance[w] <= margin))
          continue;
        // A part in contact, at least some steps long.
        int begin = -1;
        double least = 1;
        for (int i = 1; i <= kSteps; ++i) {
          const double d = i == kSteps ? 1e9 : signed_distance(other, from + (double(i) / kSteps) * along);
          if (d <= margin - 1e-6) {
            if (begin < 0) begin = i;
            least = std::min(least, std::abs(d));
          } else {
            const bool reaches_end =
                (begin == 1 && distance[v] <= margin + 0.02) || (i == kSteps && distance[w] <= margin + 0.02);
            if (begin > 0 && i - begin > 2 && !reaches_end && i < kSteps) {
              ++parts;
              const auto on_part = [&](const Contact& c) {
                const Vec3 x = point(c) - from;
                const double t = dot(x, along) / squared_norm(along);
                return c.id >> 63 == static_cast<std::uint64_t>(body) && norm(x - t * along) < 1e-6 &&
                       t > double(begin - 1.01) / kSteps && t < double(i + 0.01) / kSteps;
              };
              EXPECT_TRUE(std::ranges::any_of(contacts, on_part)) << v << ' ' << w;
            }
            begin = -1;
          }
        }
      }
    }
  }
  EXPECT_GT(vertices, 500u);
  EXPECT_GT(parts, 100u);
}

/// Signed distances of points from a solid, by the reference engine; negative inside.
std::vector<double> signed_distances(const Sites& solid, std::span<const Vec3> points) {
  const auto closest = closest_points(solid, points, {.engine = make_engine("reference")});
  const auto inside = inside_flags(solid, points, closest, SignMethod::exact);
  std::vector<double> distances;
  for (std::size_t i = 0; i < points.size(); ++i)
    distances.push_back(inside[i] != 0 ? -closest[i].distance : closest[i].distance);
  return distances;
}

// All vertices of fine meshes: shallow, deep, nested, with and without a margin.
TEST(Contacts, AreTheDeepestVerticesOfFineMeshes) {
  const std::vector<Mesh> meshes{load("cow.off", "fit"), placed(sphere(4), "scale:0.5"),
                                 placed(torus(96, 48), "fit")};
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::size_t vertices = 0, deep = 0;
  for (int trial = 0; trial < 36; ++trial) {
    SCOPED_TRACE(trial);
    const std::array<Mesh, 2> bodies{meshes[static_cast<std::size_t>(trial) % 3],
                                     meshes[static_cast<std::size_t>(trial / 3) % 3]};
    ProximityQuery query(bodies[0], bodies[1], {.contact_margin = trial % 4 == 3 ? 0.01 : 0});
    const double margin = trial % 4 == 3 ? 0.01 : 0, spread = 0.1 * (trial % 5);
    const Transform pose =
        Transform::translation({spread * normal(random), spread * normal(random), spread * normal(random)}) *
        Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
    query.set_pose(1, pose);
    std::array<Mesh, 2> placed = bodies;
    transform(placed[1].positions, pose);
    const std::array<Sites, 2> sites{Sites(placed[0]), Sites(placed[1])};
    for (const int body : {0, 1}) {
      const std::vector<Vec3>& positions = placed[body].positions;
      const std::vector<double> distances = signed_distances(sites[1 - body], positions);
      const double part = diagonal(bounds(bodies[body])) / 16;
      std::vector<Contact> contacts;  // of vertices
      for (const Contact& c : query.contacts())
        if (static_cast<int>(c.id >> 63) == body && (c.id >> 61 & 1) == 0) contacts.push_back(c);
      const auto point = [&](const Contact& c) { return body == 0 ? c.point1 : c.point2; };
      for (const Contact& c : contacts) {
        const auto nearest = std::ranges::min_element(
            positions, {}, [&](const Vec3& p) { return squared_norm(p - point(c)); });
        ASSERT_LT(norm(*nearest - point(c)), 1e-9);
        const double distance = distances[static_cast<std::size_t>(nearest - positions.begin())];
        EXPECT_LE(distance, margin + 1e-9);
        // A vertex by itself may be supported by a face that is farther away.
        if ((c.id >> 60 & 1) == 0) continue;
        EXPECT_GE(c.depth, -distance - 1e-9);
        const bool intersects_itself =
            static_cast<std::size_t>(body == 0 ? trial / 3 : trial) % 3 == 0;  // the cow
        if (!intersects_itself) {
          EXPECT_NEAR(c.depth, -distance, 1e-9);
        }
        deep += c.depth > part;
      }
      for (std::size_t v = 0; v < positions.size(); ++v) {
        if (!(distances[v] <= margin - 1e-9)) continue;
        ++vertices;
        EXPECT_TRUE(std::ranges::any_of(contacts,
                                        [&](const Contact& c) {
                                          return c.depth >= -distances[v] - 1e-9 &&
                                                 norm(point(c) - positions[v]) <=
                                                     std::max(part, c.depth) + 1e-6;
                                        }))
            << body << ' ' << v << ' ' << distances[v];
      }
    }
  }
  EXPECT_GT(vertices, 20000u);
  EXPECT_GT(deep, 100u);
}

// Halves of the near faces, and parts of the features of both bodies, are on any core.
TEST(Contacts, DoNotDependOnTheNumberOfThreads) {
  const std::vector<Mesh> meshes{load("cow.off", "fit"), placed(sphere(4), "scale:0.5"), cube(0.4)};
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::size_t contacts = 0;
  for (std::size_t trial = 0; trial < 27; ++trial) {
    SCOPED_TRACE(trial);
    const Transform pose =
        Transform::translation({0.1 * normal(random), 0.1 * normal(random), 0.1 * normal(random)}) *
        Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
    std::array<std::vector<Contact>, 2> found;
    for (const std::size_t i : {0, 1}) {
      const ThreadLimit limit(i == 0 ? 1 : 2);
      ProximityQuery query(meshes[trial % 3], meshes[trial / 3 % 3],
                           {.contact_margin = trial % 2 == 0 ? 0 : 0.02});
      query.set_pose(1, pose);
      const std::span<const Contact> all = query.contacts();
      found[i].assign(all.begin(), all.end());
    }
    ASSERT_EQ(found[0].size(), found[1].size());
    for (std::size_t c = 0; c < found[0].size(); ++c) {
      const Contact &one = found[0][c], &two = found[1][c];
      EXPECT_EQ(one.id, two.id);
      EXPECT_EQ(one.patch, two.patch);
      EXPECT_EQ(one.depth, two.depth);
      EXPECT_EQ(one.point1, two.point1);
      EXPECT_EQ(one.point2, two.point2);
      EXPECT_EQ(one.normal, two.normal);
      EXPECT_EQ(one.on, two.on);
    }
    contacts += found[0].size();
  }
  EXPECT_GT(contacts, 2000u);
}

// A support replaces the closest point of a corner, not of a vertex of a smooth surface.
TEST(Contacts, OfSmoothBodiesAreNoDeeperThanTheBodies) {
  ProximityQuery query(load("bunny.obj", "fit"), load("armadillo.off", "fit,translate:0.1:0:0"));
  ASSERT_GT(query.contacts().size(), 100u);
  EXPECT_LT(query.contacts().size(), 4000u);  // of 35,000 and 26,000 vertices
  for (const Contact& contact : query.contacts())
    ASSERT_LE(contact.depth, query.penetration_depth()->upper + 1e-6);
}

}  // namespace
}  // namespace sdm::test

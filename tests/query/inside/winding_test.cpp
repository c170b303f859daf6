// Generalised winding numbers against the sum of solid angles in extended precision, and inside tests that
// are kept with their sites.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <array>
#include <barrier>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "geometry/vec.h"
#include "query/inside/solid_angle.h"
#include "query/inside/solid_angles.h"
#include "query/inside/winding_number.h"
#include "sites/sites_data.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

constexpr double kFullAngle = 4 * std::numbers::pi;

using Extended = std::array<long double, 3>;

long double dot_of(const Extended& a, const Extended& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The sum over all faces as they are oriented.
double brute_force(const Sites& sites, const Vec3& q) {
  const sites::SitesData& data = internals(sites);
  long double sum = 0;
  for (std::uint32_t f = 0; f < data.mesh.triangles.size(); ++f) {
    if (data.topology.ignored(f)) continue;
    std::array<Extended, 3> r;
    std::array<long double, 3> length;
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = data.mesh.positions[data.mesh.triangles[f][i]];
      for (int k = 0; k < 3; ++k) r[i][k] = static_cast<long double>(p[k]) - q[k];
      length[i] = std::sqrt(dot_of(r[i], r[i]));
    }
    const auto& [a, b, c] = r;
    const Extended normal{b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
    const long double angle =
        2 * std::atan2(dot_of(a, normal), length[0] * length[1] * length[2] + dot_of(a, b) * length[2] +
                                              dot_of(b, c) * length[0] + dot_of(c, a) * length[1]);
    sum += data.inverted[f] ? -angle : angle;
  }
  return static_cast<double>(sum / (4 * std::numbers::pi_v<long double>));
}

Mesh without_faces(Mesh mesh, const auto& drop) {
  std::size_t f = 0;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 centre = (1.0 / 3) * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
    return drop(f++, centre);
  });
  return mesh;
}

// Each triangle with corners of its own, all at slightly different places.
Mesh soup_of(const Mesh& mesh) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
  Mesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : t) {
      const Vec3& p = mesh.positions[v];
      soup.positions.push_back({p[0] + noise(random), p[1] + noise(random), p[2] + noise(random)});
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

// A strip with one side, around the z axis.
Mesh moebius_strip() {
  Mesh mesh;
  constexpr std::uint32_t kParts = 40;
  for (std::uint32_t i = 0; i < kParts; ++i) {
    const double turn = 2 * std::numbers::pi * i / kParts;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(turn / 2);
      mesh.positions.push_back({r * std::cos(turn), r * std::sin(turn), s * std::sin(turn / 2)});
    }
  }
  for (std::uint32_t i = 0; i < kParts; ++i) {
    const bool last = i + 1 == kParts;
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  return mesh;
}

struct OpenMesh {
  std::string name;
  Mesh mesh;
};

std::vector<OpenMesh> open_meshes() {
  const Mesh ball = test::sphere(4), elephant = test::load("elephant-with-holes.off", "fit");
  // An edge of three faces, and shells of both orientations that overlap.
  Mesh fin = test::cube();
  fin.positions.push_back({3, 0.2, 0.1});
  fin.triangles.push_back({0, 1, static_cast<std::uint32_t>(fin.positions.size() - 1)});
  return {
      {"half a ball", without_faces(ball, [](std::size_t, const Vec3& c) { return c[2] > 0.1; })},
      {"a ball with many holes", without_faces(ball, [](std::size_t f, const Vec3&) { return f % 29 == 0; })},
      {"half of the faces of a ball",
       without_faces(ball, [](std::size_t f, const Vec3&) { return f % 2 == 0; })},
      {"soup", soup_of(test::sphere(3))},
      {"separate triangles that meet",
       [&] {
         Mesh mesh = soup_of(test::sphere(2));
         for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
           for (int k = 0; k < 3; ++k)
             mesh.positions[mesh.triangles[i][k]] =
                 test::sphere(2).positions[test::sphere(2).triangles[i][k]];
         mesh.triangles.pop_back();
         return mesh;
       }()},
      {"a cube with a fin", fin},
      {"a strip with one side", moebius_strip()},
      {"two open shells that overlap",
       test::joined(without_faces(ball, [](std::size_t, const Vec3& c) { return c[0] > 0.4; }),
                    test::moved(test::flipped(without_faces(
                                    ball, [](std::size_t, const Vec3& c) { return c[1] > 0.2; })),
                                {0.5, 0.2, 0.1}))},
      {"elephant", elephant},
  };
}

// In the box, near the mesh, on the planes of holes, and on lines between vertices, which closing faces
// share.
std::vector<Vec3> query_points(const Mesh& mesh, std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1.2, 1.2), small(-0.02, 0.02);
  const auto vertex = [&] { return mesh.positions[random() % mesh.positions.size()]; };
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({u(random), u(random), u(random)});
    const Vec3 near = vertex();
    points.push_back({near[0] + small(random), near[1] + small(random), near[2] + small(random)});
    points.push_back(0.5 * (vertex() + vertex()));
    points.push_back((1.0 / 3) * (vertex() + vertex() + vertex()));
  }
  return points;
}

double distance_of(const Sites& sites, const Vec3& point) {
  return closest_points(sites, std::vector{point})[0].distance;
}

TEST(Winding, IsTheSumOfSolidAnglesWithinTheErrorAskedFor) {
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    const inside::WindingNumber winding(internals(sites));
    for (const Vec3& q : query_points(mesh, 20)) {
      if (distance_of(sites, q) < 1e-9) continue;
      const double exact = brute_force(sites, q);
      for (const double error : {0.2, 1e-2, 1e-4, 0.0})
        ASSERT_NEAR(winding(q, error), exact, error + 1e-11) << q[0] << ' ' << q[1] << ' ' << q[2];
    }
  }
}

// Bounds on the rounding of expansions hold where coordinates have few digits left.
TEST(Winding, IsTheSumOfSolidAnglesFarFromTheOrigin) {
  constexpr double kFar = 1e6;
  const Vec3 offset{kFar, -2 * kFar, 0.7 * kFar};
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(test::moved(mesh, offset));
    const inside::WindingNumber winding(internals(sites));
    const inside::SolidAngles angles(inside::oriented_faces(internals(sites)), internals(sites).wide);
    for (const Vec3& p : query_points(mesh, 10)) {
      const Vec3 q = p + offset;
      if (distance_of(sites, q) < 1e-8) continue;
      const double exact = brute_force(sites, q);
      for (const double error : {0.2, 1e-2, 1e-4, 1e-8, 0.0}) {
        ASSERT_NEAR(winding(q, error), exact, error + 1e-11) << p[0] << ' ' << p[1] << ' ' << p[2];
        const inside::SolidAngle sum =
            angles.at(q, std::numeric_limits<double>::quiet_NaN(), kFullAngle * error).angle;
        ASSERT_NEAR(sum.value, kFullAngle * exact, sum.error)
            << error << ": " << p[0] << ' ' << p[1] << ' ' << p[2];
      }
    }
  }
}

// Expansions in single precision have no range there.
TEST(Winding, IsTheSumOfSolidAnglesFarFromTheMesh) {
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    const inside::SolidAngles angles(inside::oriented_faces(internals(sites)), internals(sites).wide);
    for (const double far : {10.0, 1e3, 1e5, 9e5, 1.1e6, 1e9, 1e30})
      for (const Vec3& q : {Vec3{far, 0, 0}, Vec3{-0.3 * far, 0.7 * far, far}})
        for (const double error : {0.1, 1e-6, 0.0}) {
          const inside::SolidAngles::Sum sum = angles.at(q, 0.5 * kFullAngle, kFullAngle * error);
          const double exact = kFullAngle * brute_force(sites, q);
          EXPECT_NEAR(sum.angle.value, exact, sum.angle.error + 1e-300) << far << ' ' << error;
          EXPECT_LT(sum.angle.error, 0.5 * kFullAngle);
        }
  }
}

TEST(Winding, SumsOfAnglesCountTurns) {
  const Mesh ball = test::sphere(2);
  inside::SolidAngleSum sum;
  double expected = 0;
  const auto add = [&](bool reverse) {
    for (const auto& [a, b, c] : ball.triangles) {
      const auto &p = ball.positions[a], &q = ball.positions[reverse ? c : b],
                 &r = ball.positions[reverse ? b : c];
      sum.add(inside::half_solid_angle(p, q, r));
      expected += inside::solid_angle(p, q, r);
      ASSERT_NEAR(sum.sum().value, expected, 1e-11);
    }
  };
  for (int i = 0; i < 3; ++i) add(false);
  EXPECT_NEAR(sum.sum().value, 3 * kFullAngle, sum.sum().error);
  for (int i = 0; i < 8; ++i) add(true);
  EXPECT_NEAR(sum.sum().value, -5 * kFullAngle, sum.sum().error);
  EXPECT_LT(sum.sum().error, 1e-9);
  // Each nearly a whole turn, from both sides of a large triangle.
  const Vec3 x{1e3, 0, 1e-6}, y{-1e3, 1e3, 1e-6}, z{-1e3, -1e3, 1e-6};
  inside::SolidAngleSum wide;
  for (int i = 1; i <= 7; ++i) {
    wide.add(inside::half_solid_angle(x, y, z));
    ASSERT_NEAR(wide.sum().value, i * inside::solid_angle(x, y, z), 1e-9);
  }
  for (int i = 6; i >= -7; --i) {
    wide.add(inside::half_solid_angle(x, z, y));
    ASSERT_NEAR(wide.sum().value, i * inside::solid_angle(x, y, z), 1e-9);
  }
}

TEST(Winding, IsComparedWithOneHalfRightly) {
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    ASSERT_EQ(choose_sign(sites, SignMethod::winding).method, SignMethod::winding);
    const std::vector<Vec3> points = query_points(mesh, 40);
    const std::vector<ClosestPoint> closest = closest_points(sites, points);
    const std::vector<std::uint8_t> inside = inside_flags(sites, points, closest, SignMethod::winding);
    std::size_t certain = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double exact = brute_force(sites, points[i]);
      if (closest[i].distance < 1e-9 || std::abs(exact - 0.5) < 1e-11) continue;
      ++certain;
      ASSERT_EQ(inside[i] != 0, exact > 0.5) << i << ": " << exact;
    }
    EXPECT_GT(certain, points.size() / 2);
  }
}

// Numbers beside faces are kept, once enough points ask for them.
TEST(Winding, IsKnownBesideFaces) {
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    std::vector<Vec3> points = query_points(mesh, 10);
    const std::size_t step = 1 + mesh.triangles.size() / 30;
    for (std::size_t f = 0; f < mesh.triangles.size(); f += step) {
      const auto& [a, b, c] = mesh.triangles[f];
      const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
      const Vec3 normal = normalized(cross(q - p, r - p));
      for (const Vec3& at : {(1.0 / 3) * (p + q + r), 0.5 * (p + q), p})
        for (const double height : {1e-8, -1e-8, 1e-5, -1e-5, 1e-3, -1e-3})
          points.push_back(at + height * normal);
    }
    std::vector<Vec3> many;
    while (many.size() < mesh.triangles.size()) many.insert(many.end(), points.begin(), points.end());
    const std::vector<ClosestPoint> closest = closest_points(sites, many);
    const auto inside = inside_flags(sites, many, closest, SignMethod::winding);
    const auto again = inside_flags(sites, many, closest, SignMethod::winding);
    EXPECT_EQ(inside, again);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double exact = brute_force(sites, points[i]);
      if (closest[i].distance < 1e-9 || std::abs(exact - 0.5) < 1e-11) continue;
      ASSERT_EQ(inside[i] != 0, exact > 0.5) << i << ": " << exact << " at " << closest[i].distance;
    }
  }
}

// Samples next to each other take over signs.
TEST(Winding, IsComparedRightlyInMaps) {
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 96});
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    const DistanceMap map = compute_map(surface, sites, {.sign = SignMethod::winding});
    const std::vector<Vec3> points = surface.sample_points();
    for (std::size_t i = 0; i < points.size(); i += 11) {
      const double exact = brute_force(sites, points[i]), distance = map.distance[surface.sample_texels()[i]];
      if (std::abs(distance) < 1e-5 || std::abs(exact - 0.5) < 1e-11) continue;
      ASSERT_EQ(distance<0, exact> 0.5) << i << ": " << exact << " at " << distance;
    }
  }
}

// Meshes whose signs are kept: by sides of faces, and by winding numbers.
std::vector<Mesh> kept_meshes() {
  return {test::load("elephant.off", "fit"), test::load("elephant-with-holes.off", "fit")};
}

std::vector<std::uint8_t> flags(const Sites& sites, const std::vector<Vec3>& points) {
  return inside_flags(sites, points, closest_points(sites, points), SignMethod::winding);
}

TEST(KeptSigns, SinglePointsAreThoseOfABatch) {
  for (const Mesh& mesh : kept_meshes()) {
    const Sites sites(mesh), others(mesh);
    const std::vector<Vec3> points = query_points(mesh, 200);
    const std::vector<std::uint8_t> all = flags(sites, points);
    std::vector<Vec3> many;  // enough to be asked for face by face
    while (many.size() < mesh.triangles.size()) many.insert(many.end(), points.begin(), points.end());
    const std::vector<std::uint8_t> of_many = flags(others, many);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (distance_of(sites, points[i]) < 1e-5) continue;
      EXPECT_EQ(flags(sites, {points[i]})[0], all[i]) << i;
      EXPECT_EQ(of_many[i], all[i]) << i;
    }
  }
}

TEST(KeptSigns, AreThoseOfThePresentShape) {
  for (const Mesh& mesh : kept_meshes()) {
    Sites sites(mesh);
    const std::vector<Vec3> points = query_points(mesh, 200);
    const std::vector<std::uint8_t> before = flags(sites, points);
    std::vector<Vec3> moved = mesh.positions;
    for (Vec3& p : moved) p = {0.6 * p[0] + 0.3, 0.5 * p[1], p[2] - 0.2};
    sites.refit(moved);
    Mesh fresh = mesh;
    fresh.positions = moved;
    EXPECT_EQ(flags(sites, points), flags(Sites(fresh), points));
    EXPECT_NE(flags(sites, points), before);

    MeshEdit edit;
    edit.removed_faces = {0, 5, 77};
    sites.edit(edit);
    EXPECT_EQ(flags(sites, points), flags(Sites(sites.mesh()), points));
  }
}

TEST(KeptSigns, AreMadeOnceByConcurrentCalls) {
  for (const Mesh& mesh : kept_meshes())
    for (int round = 0; round < 5; ++round) {
      const Sites sites(mesh);
      const std::vector<Vec3> points = query_points(mesh, 20);
      std::array<std::vector<std::uint8_t>, 4> found;
      {
        std::barrier together(static_cast<std::ptrdiff_t>(found.size()));
        std::vector<std::jthread> threads;
        for (auto& mine : found)
          threads.emplace_back([&] {
            together.arrive_and_wait();
            mine = flags(sites, points);
          });
      }
      const std::vector<std::uint8_t> alone = flags(sites, points);
      for (const auto& each : found) EXPECT_EQ(each, alone);
    }
}

TEST(KeptSigns, QueriesThatAreNoNumbersAreErrors) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  for (const Mesh& mesh : kept_meshes()) {
    const Sites sites(mesh);
    for (const double bad : {nan, inf, -inf, 1e38})
      for (int k = 0; k < 3; ++k) {
        std::vector<Vec3> points{{0, 0, 0}, {0, 0, 0}};
        const std::vector<ClosestPoint> closest = closest_points(sites, points);
        points[1][k] = bad;
        EXPECT_THROW((void)closest_points(sites, points), Error);
        EXPECT_THROW((void)closest_points(sites, std::vector{points[1]}), Error);
        for (const SignMethod method : {SignMethod::winding, SignMethod::side})
          EXPECT_THROW((void)inside_flags(sites, points, closest, method), Error);
      }
  }
}

}  // namespace
}  // namespace sdm

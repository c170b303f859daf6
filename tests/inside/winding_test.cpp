// Generalised winding numbers against the sum of solid angles in extended precision, and inside tests that
// are kept with their sites.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "inside/angles/solid_angle.h"
#include "inside/angles/solid_angles.h"
#include "inside/open_meshes.h"
#include "inside/winding_number.h"
#include "sites/sites_data.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using test::brute_force_winding, test::open_meshes, test::points_about;

constexpr double kFullAngle = 4 * std::numbers::pi;

double distance_of(const Sites& sites, const Vec3& point) {
  return closest_points(sites, std::vector{point})[0].distance;
}

TEST(Winding, IsTheSumOfSolidAnglesWithinTheErrorAskedFor) {
  for (const auto& [name, mesh] : open_meshes()) {
    SCOPED_TRACE(name);
    const Sites sites(mesh);
    const inside::WindingNumber winding(internals(sites));
    for (const Vec3& q : points_about(mesh, 20)) {
      if (distance_of(sites, q) < 1e-9) continue;
      const double exact = brute_force_winding(sites, q);
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
    for (const Vec3& p : points_about(mesh, 10)) {
      const Vec3 q = p + offset;
      if (distance_of(sites, q) < 1e-8) continue;
      const double exact = brute_force_winding(sites, q);
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
          const double exact = kFullAngle * brute_force_winding(sites, q);
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
    const std::vector<Vec3> points = points_about(mesh, 40);
    const std::vector<ClosestPoint> closest = closest_points(sites, points);
    const std::vector<std::uint8_t> inside = inside_flags(sites, points, closest, SignMethod::winding);
    std::size_t certain = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double exact = brute_force_winding(sites, points[i]);
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
    std::vector<Vec3> points = points_about(mesh, 10);
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
      const double exact = brute_force_winding(sites, points[i]);
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
      const double exact = brute_force_winding(sites, points[i]),
                   distance = map.distance[surface.sample_texels()[i]];
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
    const std::vector<Vec3> points = points_about(mesh, 200);
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
    const std::vector<Vec3> points = points_about(mesh, 200);
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
      const std::vector<Vec3> points = points_about(mesh, 20);
      std::array<std::vector<std::uint8_t>, 4> found;
      {
        // Together, as soon as all have arrived; not by std::barrier, which may wait forever in GCC 12 for
        // Windows.
        std::atomic<std::size_t> arrived{0};
        std::vector<std::jthread> threads;
        for (auto& mine : found)
          threads.emplace_back([&] {
            for (++arrived; arrived < found.size();) std::this_thread::yield();
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

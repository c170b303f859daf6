// Winding numbers of packets of points, compared with those of single points and with sums in extended
// precision.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "inside/angles/packet_angles.h"
#include "inside/open_meshes.h"
#include "inside/winding_number.h"
#include "scenes/scene.h"
#include "sites/sites_data.h"
#include "support/every_case.h"
#include "support/meshes.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm {
namespace {

using test::brute_force_winding, test::open_meshes;

constexpr double kWhole = 4 * std::numbers::pi;

inside::SolidAngles angles_of(const Sites& sites) {
  return {inside::oriented_faces(internals(sites)), internals(sites).wide};
}

std::vector<Vec3> around(const Vec3& centre, double radius, std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> u(-radius, radius);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(centre + Vec3{u(random), u(random), u(random)});
  return points;
}

// Packets of all sizes, far from the mesh, beside it and on it, with limits on both sides of the sums and
// near to them.
TEST(PacketAngles, AreOnTheSideOfSumsInExtendedPrecision) {
  std::mt19937 random(3);
  for (const auto& [name, mesh] : open_meshes())
    for (const double far : {0.0, 1e6}) {
      SCOPED_TRACE(name + " at " + std::to_string(far));
      const Vec3 offset{far, -2 * far, 0.7 * far};
      const Sites sites(test::moved(mesh, offset));
      const inside::SolidAngles angles = angles_of(sites);
      std::size_t known = 0, all = 0;
      for (const Vec3& centre : test::points_about(mesh, test::subset(1, 2)))
        for (const double radius : {0.0, 1e-7, 1e-3, 0.05, 0.4}) {
          const std::vector<Vec3> points = around(centre + offset, radius, 1 + random() % 16, random);
          std::vector<double> exact, limits;
          for (const Vec3& q : points) {
            constexpr std::array kFrom{-6.0, -0.5, -1e-3, 1e-3, 0.5, 6.0};
            exact.push_back(kWhole * brute_force_winding(sites, q));
            limits.push_back(exact.back() + kFrom[random() % kFrom.size()]);
          }
          const inside::PacketSides sides = inside::sides_of_packet(angles, points, limits);
          EXPECT_EQ(sides.above & ~sides.known, 0u);
          for (std::size_t i = 0; i < points.size(); ++i)
            if ((sides.known >> i & 1u) != 0) {
              ASSERT_EQ((sides.above >> i & 1u) != 0, exact[i] > limits[i])
                  << radius << ": " << exact[i] << " and " << limits[i];
            }
          if (radius <= 1e-3) {
            known += std::popcount(sides.known);
            all += points.size();
          }
        }
      if (far == 0) {
        EXPECT_GT(known, all / 5);
      }
    }
}

// Balls of all sizes up to that which touches the mesh: where the side is known, no point of them is on the
// other one. Most of a tenth of that size beside a smooth surface are known.
TEST(PacketAngles, BallsAreOnTheSideOfSumsInExtendedPrecision) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  const Mesh ball = test::soup_of(test::sphere(5));
  std::vector<test::OpenMesh> meshes = open_meshes();
  meshes.push_back({"fine soup", ball});
  for (const auto& [name, mesh] : meshes)
    for (const double far : {0.0, 1e6}) {
      SCOPED_TRACE(name + " at " + std::to_string(far));
      const Vec3 offset{far, -2 * far, 0.7 * far};
      const Sites sites(test::moved(mesh, offset));
      const inside::SolidAngles angles = angles_of(sites);
      std::vector<Vec3> centres = test::points_about(mesh, test::subset(1, 3));
      for (Vec3& p : centres) p += offset;
      const std::vector<ClosestPoint> closest = closest_points(sites, centres);
      std::size_t known = 0, tried = 0;
      for (std::size_t i = 0; i < centres.size(); ++i)
        for (const double part : {0.01, 0.1, 0.25, 0.5, 0.99}) {
          const double radius = part * closest[i].distance;
          const bool far_from_limit = random() % 2 == 0;
          const double limit =
              kWhole * (brute_force_winding(sites, centres[i]) + (far_from_limit ? 0.5 : -0.1));
          const inside::PacketSides side = inside::side_of_ball(angles, centres[i], radius, limit);
          EXPECT_EQ(side.above & ~side.known, 0u);
          if (part == 0.1 && far_from_limit) {
            ++tried;
            known += side.known;
          }
          if (side.known == 0) continue;
          for (int sample = 0; sample < 6; ++sample) {
            const Vec3 direction = normalized(Vec3{u(random), u(random), u(random)});
            const Vec3 q = centres[i] + (sample % 2 == 0 ? 1 : 0.5) * radius * direction;
            ASSERT_EQ(side.above != 0, kWhole * brute_force_winding(sites, q) > limit) << part;
          }
        }
      if (name == "fine soup" && far == 0) {
        EXPECT_GT(known, tried / 3);
      }
    }
}

TEST(PacketAngles, BallsThatMeetFacesAreUnknown) {
  const Sites sites(test::open_meshes()[3].mesh);
  const inside::SolidAngles angles = angles_of(sites);
  for (const Vec3& q : test::points_about(sites.mesh(), 5)) {
    const double distance = closest_points(sites, std::vector{q})[0].distance;
    for (const double part : {1.0001, 2.0, 10.0})
      EXPECT_EQ(inside::side_of_ball(angles, q, part * distance + 1e-9, 100).known, 0u);
  }
  EXPECT_EQ(inside::side_of_ball(angles, {1e9, 0, 0}, 1, 100).known, 0u);
}

TEST(PacketAngles, AreUnknownOnFacesAndWhereRoundingDecides) {
  const Sites sites(test::open_meshes()[3].mesh);
  const inside::SolidAngles angles = angles_of(sites);
  for (const Triangle& t : sites.mesh().triangles) {
    const auto& p = sites.mesh().positions;
    const Vec3 centre = (1.0 / 3) * (p[t[0]] + p[t[1]] + p[t[2]]), edge = 0.5 * (p[t[0]] + p[t[1]]);
    const std::vector<Vec3> points{centre, edge, p[t[0]], centre};
    EXPECT_EQ(inside::sides_of_packet(angles, points, std::vector(4, 0.5 * kWhole)).known, 0u);
  }
  const std::vector<Vec3> out{{1e9, 0, 0}, {1e9, 1, 0}};
  EXPECT_EQ(inside::sides_of_packet(angles, out, std::vector(2, 0.5 * kWhole)).known, 0u);
  EXPECT_EQ(inside::sides_of_packet(angles, {}, {}).known, 0u);
}

// So near to a face that single precision does not decide its angle, in packets and alone.
TEST(PacketAngles, AreKnownBesideFaces) {
  const Sites sites(test::soup_of(test::sphere(3)));
  const inside::SolidAngles angles = angles_of(sites);
  const auto& p = sites.mesh().positions;
  std::size_t known = 0, all = 0;
  for (const Triangle& t : sites.mesh().triangles) {
    const Vec3 centre = (1.0 / 3) * (p[t[0]] + p[t[1]] + p[t[2]]);
    const Vec3 normal = normalized(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    std::vector<Vec3> points;
    for (const double height : {1e-9, -1e-9, 1e-8, -1e-7}) points.push_back(centre + height * normal);
    for (const bool alone : {false, true})
      for (std::size_t i = 0; i < points.size(); i += alone ? 1 : points.size()) {
        const auto packet = std::span(points).subspan(i, alone ? 1 : points.size());
        const inside::PacketSides sides =
            inside::sides_of_packet(angles, packet, std::vector(packet.size(), 0.5 * kWhole));
        for (std::size_t k = 0; k < packet.size(); ++k) {
          ++all;
          if ((sides.known >> k & 1u) == 0) continue;
          ++known;
          ASSERT_EQ((sides.above >> k & 1u) != 0, brute_force_winding(sites, packet[k]) > 0.5);
        }
      }
  }
  EXPECT_GT(known, all * 9 / 10);
}

// Turns are counted: sixty shells, one in the other, of both orientations.
TEST(PacketAngles, CountTurns) {
  for (const bool reverse : {false, true}) {
    Mesh shells;
    for (int i = 0; i < 60; ++i) {
      Mesh shell =
          test::without_faces(test::cube(1 + 1e-3 * i), [](std::size_t f, const Vec3&) { return f == 0; });
      shells = test::joined(shells, reverse ? test::flipped(shell) : shell);
    }
    const Sites sites(shells);
    const inside::SolidAngles angles = angles_of(sites);
    std::mt19937 random(8);
    const std::vector<Vec3> points = around({-0.3, 0.2, 0.1}, 0.05, 16, random);
    for (int n = -61; n <= 61; ++n) {
      std::vector<double> limits;
      const double limit = kWhole * (n + 0.05);
      const inside::PacketSides sides =
          inside::sides_of_packet(angles, points, std::vector(points.size(), limit));
      EXPECT_GT(std::popcount(sides.known), 8);
      for (std::size_t i = 0; i < points.size(); ++i)
        if ((sides.known >> i & 1u) != 0) {
          ASSERT_EQ((sides.above >> i & 1u) != 0, kWhole * brute_force_winding(sites, points[i]) > limit);
        }
    }
  }
}

// Where a ball or a packet decides, the sign is that of a sum of its own, to the bit.
TEST(PacketAngles, SignsOfMapsAndBatchesAreThoseOfSinglePoints) {
  std::vector<test::OpenMesh> meshes = open_meshes();
  meshes.push_back({"cow, taken apart", test::taken_apart(test::load("cow.off", "fit"), 1e-4)});
  meshes.push_back(
      {"letter", test::taken_apart(scenes::Scene(scenes::SceneKind::letters).bodies()[0].mesh, 1e-3)});
  std::mt19937 random(17);
  meshes.push_back({"small triangles", test::soup(3000, random)});
  meshes.push_back({"degenerate triangles", test::degenerate_soup(2000, 4)});
  const std::vector<std::pair<std::string, Mesh>> others{{"cow", test::load("cow.off", "fit")},
                                                         {"ball", test::sphere(3)}};
  for (const auto& [name, mesh] : meshes) {
    std::vector<std::pair<std::string, Mesh>> measured = others;
    measured.emplace_back("itself", mesh);
    for (const auto& [of, o1] : measured) {
      SCOPED_TRACE(of + " to " + name);
      const Sites sites(mesh);
      if (choose_sign(sites, SignMethod::winding).method != SignMethod::winding) continue;
      const Surface surface(o1, {.resolution = o1.triangles.size() < 2000 || of != "itself" ? 128u : 256u});
      const DistanceMap map = compute_map(surface, sites, {.sign = SignMethod::winding});
      const std::vector<Vec3> points = surface.sample_points();
      const std::vector<ClosestPoint> closest = closest_points(sites, points);
      const std::vector<std::uint8_t> flags = inside_flags(sites, points, closest, SignMethod::winding);
      const inside::WindingNumber winding(internals(sites));
      std::size_t negative = 0;
      for (std::size_t i = 0; i < points.size(); i += 3) {
        const float distance = map.distance[surface.sample_texels()[i]];
        const bool expected =
            closest[i].distance != 0 && winding.above_half(points[i], closest[i], false).above;
        ASSERT_EQ(flags[i] != 0, expected) << i << " at " << closest[i].distance;
        if (closest[i].distance > 0 && distance != 0) {
          ASSERT_EQ(std::signbit(distance), expected) << i << " at " << distance;
        }
        negative += expected ? 1 : 0;
      }
      if (of != "ball" && name == "cow, taken apart") {
        EXPECT_GT(negative, points.size() / 30);
      }
    }
  }
}

TEST(PacketAngles, SignsAreTheSameWithEverySetOfInstructionsAndAnyNumberOfThreads) {
  const Mesh mesh = test::taken_apart(test::load("cow.off", "fit"), 1e-3);
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 128});
  const auto signs = [&] {
    const DistanceMap map = compute_map(surface, Sites(mesh), {.sign = SignMethod::winding});
    std::vector<std::uint8_t> result;
    for (const std::uint32_t texel : surface.sample_texels())
      result.push_back(std::signbit(map.distance[texel]));
    return result;
  };
  const std::vector<std::uint8_t> expected = signs();
  for (const test::SimdTarget target : test::simd_targets())
    for (const unsigned threads : {1u, 3u}) {
      SCOPED_TRACE(test::name(target));
      const test::UseSimdTarget use(target);
      const ThreadLimit limit(threads);
      EXPECT_EQ(signs(), expected);
    }
}

}  // namespace
}  // namespace sdm

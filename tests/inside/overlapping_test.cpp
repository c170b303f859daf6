// The sign at every texel of maps to closed meshes that intersect themselves, against winding numbers by
// solid angles.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/engines.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

/// A closed mesh that intersects itself, with every shell oriented outwards.
struct SignScene {
  const char* name;
  std::function<Mesh()> o2;
  bool everywhere_positive = true;  ///< no part has a negative winding number
};
void PrintTo(const SignScene& scene, std::ostream* out) {
  *out << scene.name;
}

Mesh shells(const Mesh& shell, const std::vector<const char*>& placements) {
  Mesh mesh = test::placed(shell, placements.front());
  for (std::size_t i = 1; i < placements.size(); ++i)
    mesh = test::joined(mesh, test::placed(shell, placements[i]));
  return mesh;
}

Mesh bar(const Vec3& lo, const Vec3& hi) {
  Mesh mesh = test::cube(1);
  for (Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = p[k] < 0 ? lo[k] : hi[k];
  return mesh;
}

/// A torus whose tube is so thick that it covers the region around the axis twice.
Mesh spindle(std::uint32_t n) {
  Mesh mesh = test::ring(n);
  for (Vec3& p : mesh.positions) {
    const double around = std::hypot(p[0], p[1]);
    for (int k = 0; k < 2; ++k) p[k] *= (around - 0.75) / around;
  }
  return mesh;
}

/// A sphere whose lower part is turned inside out through a point of its axis.
Mesh pinched(double at) {
  Mesh mesh = test::sphere(3);
  for (Vec3& p : mesh.positions) p[0] *= p[2] - at;
  return mesh;
}

/// A sphere whose vertices are displaced at random.
Mesh noisy(int levels, double by, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-by, by);
  Mesh mesh = test::sphere(levels);
  for (Vec3& p : mesh.positions)
    for (double& x : p) x += u(random);
  return mesh;
}

/// A cube, or a real mesh, twisted around the z axis so far that its sides meet.
Mesh folded(Mesh mesh, double turns) {
  for (Vec3& p : mesh.positions) {
    const double angle = 2 * std::numbers::pi * turns * p[0];
    p = {0.3 * std::cos(angle) * (1 + p[1]), 0.3 * std::sin(angle) * (1 + p[1]), 0.7 * p[2] + 0.1 * p[0]};
  }
  return mesh;
}

/// Cubes at random places, sizes and angles.
Mesh crowd(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const std::string steps = "scale:" + std::to_string(0.4 + 0.3 * u(random)) +
                              ",rotate:" + std::to_string(180 * u(random)) + ":" +
                              std::to_string(180 * u(random)) + ":" + std::to_string(180 * u(random)) +
                              ",translate:" + std::to_string(u(random)) + ":" + std::to_string(u(random)) +
                              ":" + std::to_string(u(random));
    mesh = test::joined(mesh, test::placed(test::cube(1), steps));
  }
  return mesh;
}

Mesh pair_of(const char* file, const char* second) {
  const Mesh mesh = test::load(file, "fit,scale:2");
  return test::joined(mesh, test::placed(mesh, second));
}

const Mesh kCube = test::cube(1), kSphere = test::sphere(3);

const SignScene kSignScenes[] = {
    {"TwoCubes",
     [] {
       return test::joined(bar({0, 0, 0}, {1, 1, 1}), bar({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75}));
     }},
    {"CubesCornerInCorner",
     [] {
       return shells(kCube, {"scale:0.6", "scale:0.6,translate:0.6:0.6:0.6"});
     }},
    {"CubesThatShareAWall",
     [] {
       return shells(kCube, {"scale:0.5", "scale:0.5,translate:1:0:0"});
     }},
    {"CubesThatShareAnEdge",
     [] {
       return shells(kCube, {"scale:0.5", "scale:0.5,translate:1:1:0"});
     }},
    {"CubesWithCoplanarSides",
     [] {
       return shells(kCube, {"scale:0.5", "scale:0.5,translate:0.5:0:0"});
     }},
    {"TheSameCubeTwice",
     [] {
       return shells(kCube, {"scale:0.7", "scale:0.7"});
     }},
    {"CubesAlmostInOnePlace",
     [] {
       return shells(kCube, {"scale:0.7", "scale:0.7,translate:1e-7:0:0"});
     }},
    {"CrossOfBars",
     [] {
       return test::joined(
           test::joined(bar({-1, -0.2, -0.2}, {1, 0.2, 0.2}), bar({-0.2, -1, -0.2}, {0.2, 1, 0.2})),
           bar({-0.2, -0.2, -1}, {0.2, 0.2, 1}));
     }},
    {"CubeInTheOverlap",
     [] {
       return shells(kCube, {"scale:0.6", "scale:0.6,translate:0.3:0:0", "scale:0.1,translate:0.2:0:0"});
     }},
    {"TurnedCubes",
     [] {
       return shells(kCube, {"scale:0.6", "scale:0.6,rotate:45:0:45"});
     }},
    {"TwoSpheres",
     [] {
       return shells(kSphere, {"scale:0.7", "scale:0.7,translate:0.6:0:0"});
     }},
    {"SpheresBarelyTouching",
     [] {
       return shells(kSphere, {"scale:0.5", "scale:0.5,translate:0.99:0:0"});
     }},
    {"ThreeSpheres",
     [] {
       return shells(kSphere, {"scale:0.6", "scale:0.6,translate:0.5:0:0", "scale:0.6,translate:0:0.5:0.2"});
     }},
    {"FiveSpheresInARow",
     [] {
       return shells(kSphere, {"scale:0.4,translate:-1:0:0", "scale:0.4,translate:-0.5:0:0", "scale:0.4",
                               "scale:0.4,translate:0.5:0:0", "scale:0.4,translate:1:0:0"});
     }},
    {"SphereAndCube",
     [] {
       return test::joined(test::placed(kSphere, "scale:0.8"),
                           test::placed(kCube, "scale:0.7,rotate:20:30:40"));
     }},
    {"RingThroughCube",
     [] {
       return test::joined(test::placed(test::ring(24), "scale:0.7"),
                           test::placed(kCube, "scale:0.4,translate:0.7:0:0"));
     }},
    {"RingsIntersecting",
     [] {
       return test::joined(test::ring(24, 0.7),
                           test::placed(test::ring(24, 0.7), "rotate:90:0:0,translate:0.2:0:0"));
     }},
    {"Spindle", [] { return spindle(32); }},
    {"CoarseSpindle", [] { return spindle(9); }},
    {"PinchedLow", [] { return pinched(-0.4); }, false},
    {"PinchedHigh", [] { return pinched(-0.8); }, false},
    {"NoisyCoarse", [] { return noisy(1, 0.4, 1); }, false},
    {"NoisyFine", [] { return noisy(3, 0.15, 2); }, false},
    {"VeryNoisy", [] { return noisy(2, 0.5, 3); }, false},
    {"NoisyInCube", [] { return test::joined(noisy(2, 0.3, 4), test::placed(kCube, "scale:0.7")); }, false},
    {"FoldedSphere", [] { return folded(test::sphere(4), 0.6); }, false},
    {"FoldedElephant", [] { return folded(test::load("elephant.off", "fit,scale:2"), 0.55); }, false},
    {"CrowdOfCubes", [] { return crowd(12, 5); }},
    {"LargerCrowd", [] { return crowd(40, 6); }},
    {"Elephants", [] { return pair_of("elephant.off", "translate:0.3:0.1:0"); }},
    {"ElephantsTurned", [] { return pair_of("elephant.off", "rotate:0:90:0"); }},
    {"Knots", [] { return pair_of("knot1.off", "rotate:0:0:31,scale:0.9"); }},
    {"Hands", [] { return pair_of("hand.off", "rotate:15:0:0,translate:0.05:0:0"); }},
    {"Eights", [] { return pair_of("eight.off", "rotate:0:0:90"); }},
    {"Joints", [] { return pair_of("joint.off", "translate:0.125:0:0"); }},
    {"Anchors", [] { return pair_of("anchor.off", "rotate:90:0:0"); }},
    {"Cows", [] { return pair_of("cow.off", "translate:0.3:0.2:0.02"); }},
    {"Blobs", [] { return pair_of("blobby.off", "rotate:10:20:30"); }},
    {"Couplings", [] { return pair_of("couplingdown.off", "translate:0:0:0.2"); }},
    {"BallWithCavityAndBar",
     [] {
       const Mesh ball = test::joined(kSphere, test::flipped(test::placed(kSphere, "scale:0.6")));
       return test::joined(ball, bar({-1.2, -0.1, -0.1}, {1.2, 0.1, 0.1}));
     }},
    {"HollowBallsOverlapping",
     [] {
       const Mesh ball = test::joined(kSphere, test::flipped(test::placed(kSphere, "scale:0.3")));
       return test::joined(test::placed(ball, "scale:0.8"),
                           test::placed(ball, "scale:0.8,translate:0.7:0:0"));
     }},
    {"WedgeInWedge",
     [] { return test::joined(test::wedge(0.3), test::placed(test::wedge(0.2), "translate:0.2:0.1:0.05")); },
     false},
};

class Overlapping : public testing::TestWithParam<SignScene> {};

TEST_P(Overlapping, SignsAreThoseOfTheWindingNumber) {
  const Mesh o2 = GetParam().o2(), o1 = test::load("knot2.off", "fit,scale:2");
  const Surface surface(o1, {.resolution = 96});
  const Sites sites(o2);
  const std::vector<double> turns =
      test::evaluate([&](const Vec3& p) { return oracle::winding_number(o2, p); }, surface.sample_points());
  const double least = 1e-6 * test::scene_diagonal(o1, o2);
  for (const std::string& engine : test::engine_names()) {
    SCOPED_TRACE(engine);
    const DistanceMap map = compute_map(surface, sites, {.engine = make_engine(engine)});
    ASSERT_EQ(map.sign.method, SignMethod::exact);
    std::size_t counts[2] = {0, 0}, wrong = 0;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const double distance = map.distance[surface.sample_texels()[i]];
      if (std::abs(distance) <= least) continue;
      ++counts[turns[i] != 0];
      wrong += (distance < 0) != (turns[i] != 0);
    }
    EXPECT_EQ(wrong, 0u) << "of " << counts[0] << " outside and " << counts[1] << " inside";
    EXPECT_GT(counts[0], 0u);
    EXPECT_GT(counts[1], 0u);
  }
  if (GetParam().everywhere_positive) {
    EXPECT_GE(*std::ranges::min_element(turns), 0) << "the scene is not what it is meant to be";
  }
}
INSTANTIATE_TEST_SUITE_P(Scenes, Overlapping, testing::ValuesIn(kSignScenes),
                         [](const auto& scene) { return std::string(scene.param.name); });

// Regression: beside a small mesh far from the origin, rounding moved the points at which its sides are
// determined back onto its faces.
TEST(Sides, OfSmallMeshesFarFromTheOrigin) {
  for (const char* steps : {"scale:0.001,translate:100000:-100000:100000", "translate:1e7:1e7:1e7",
                            "scale:0.001,translate:1e7:0:0", "scale:1e-8", "scale:1e8"}) {
    SCOPED_TRACE(steps);
    const Mesh ball = test::placed(test::sphere(2), steps),
               small = test::placed(test::sphere(3), std::string("scale:0.9,") + steps);
    const Surface surface(small, {.resolution = 32});
    const DistanceMap map = compute_map(surface, Sites(ball));
    for (const std::uint32_t t : surface.sample_texels()) ASSERT_LT(map.distance[t], 0);
  }
}

}  // namespace
}  // namespace sdm

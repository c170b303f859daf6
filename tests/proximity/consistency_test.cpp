// All answers to the same question on random scenes: closed shells that overlap and intersect themselves,
// open meshes and soups. The number of scenes is 1000, or that of the environment variable SDM_SCENES (see
// tests/long); SDM_FIRST_SCENE is the first of them, to repeat one that failed.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "support/meshes.h"
#include "support/oracle.h"
#include "support/pair_oracle.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr std::uint32_t kResolution = 24;

std::array<Vec3, 3> corners(const Mesh& mesh, const Triangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

bool surfaces_intersect(const Mesh& a, const Mesh& b) {
  for (const Triangle& t : a.triangles)
    for (const Triangle& u : b.triangles)
      if (oracle::intersect(corners(a, t), corners(b, u))) return true;
  return false;
}

// The shells as one mesh, each a cavity if those that it does not meet wind around it an odd number of times.
Mesh solid_of(const std::vector<Mesh>& shells) {
  Mesh solid;
  for (const Mesh& shell : shells) {
    int turns = 0;
    for (const Mesh& other : shells)
      if (&other != &shell && !surfaces_intersect(shell, other))
        turns += oracle::winding_number(other, shell.positions[0]);
    solid = joined(solid, turns % 2 == 0 ? shell : flipped(shell));
  }
  return solid;
}

/// A mesh with what is known about it.
struct Body {
  Mesh mesh;
  bool solid = true;  ///< closed, all shells oriented outwards or, for cavities, inwards
};

class Scenes {
 public:
  explicit Scenes(unsigned seed) : random_(seed) {}

  Body body() {
    const int kind = pick(10);
    if (kind == 0) return {soup(6, random_), false};
    if (kind == 1) return {placed(square(0.8, 0.1), place()), false};
    std::vector<Mesh> shells{shell()};
    for (int more = pick(3); more > 0; --more) shells.push_back(shell());
    return {solid_of(shells)};
  }

 private:
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }

  std::string place() {
    const auto text = [](double x) { return std::to_string(x); };
    // Half of the placements are on a grid, so that shells touch and share planes.
    const bool on_grid = pick(2) == 0;
    const auto coordinate = [&] { return text(on_grid ? 0.25 * (pick(5) - 2) : number(-0.5, 0.5)); };
    const auto angle = [&] { return text(on_grid ? 90 * pick(4) : number(0, 360)); };
    const std::string scale = text(on_grid ? 0.25 * (1 + pick(2)) : number(0.15, 0.5));
    const std::string turn = angle() + ":" + angle() + ":" + angle();
    const std::string by = coordinate() + ":" + coordinate() + ":" + coordinate();
    return "scale:" + scale + ",rotate:" + turn + ",translate:" + by;
  }

  Mesh shell() {
    switch (pick(5)) {
      case 0:
        return placed(sphere(1), place());
      case 1:
        return placed(tetrahedron(), place());
      case 2: {  // intersects itself
        Mesh mesh = sphere(1);
        for (Vec3& p : mesh.positions)
          for (double& x : p) x += number(-0.3, 0.3);
        return placed(mesh, place());
      }
      case 3: {  // partly inside out
        Mesh mesh = sphere(1);
        for (Vec3& p : mesh.positions) p[0] *= p[2] + 0.4;
        return placed(mesh, place());
      }
      default:
        return placed(cube(1), place());
    }
  }

  std::mt19937 random_;
};

// Provided that the surfaces do not intersect.
bool contains_vertex(const Body& solid, const Mesh& of) {
  if (!solid.solid) return false;
  for (const Vec3& p : of.positions)
    if (oracle::winding_number(solid.mesh, p) != 0) return true;
  return false;
}

void expect_map_signs(const Body& o1, const Body& o2, double tolerance) {
  const Surface surface(o1.mesh, {.resolution = kResolution});
  const Sites sites(o2.mesh);
  const DistanceMap map = compute_map(surface, sites);
  ASSERT_EQ(map.sign.method, o2.solid ? SignMethod::exact : SignMethod::none);
  for (const std::uint32_t t : surface.sample_texels()) {
    const double d = map.distance[t];
    if (std::abs(d) <= tolerance) continue;
    const Vec3 p = surface.texel_point(t);
    ASSERT_EQ(d < 0, o2.solid && oracle::winding_number(o2.mesh, p) != 0)
        << "at " << p[0] << ' ' << p[1] << ' ' << p[2];
  }
}

// A lower bound on the depth: of the vertices inside, the largest distance to the nearest face.
double depth_by_faces(const Body& solid, const Mesh& of) {
  double deepest = 0;
  for (const Vec3& p : of.positions)
    if (oracle::winding_number(solid.mesh, p) != 0)
      deepest = std::max(deepest, oracle::brute_force(solid.mesh, p));
  return deepest;
}

// The map of a body to all others, of which there is one.
void expect_nearest_maps(const Body& a, const Body& b, const MultiBodyQuery& bodies) {
  for (const std::uint32_t i : {0u, 1u}) {
    const DistanceMap map = compute_map(bodies.surface(i), bodies.sites(1 - i));
    const NearestMap nearest = bodies.nearest_map(i);
    const Body& body = i == 0 ? b : a;
    ASSERT_EQ(nearest.map.sign.method, body.solid ? SignMethod::exact : SignMethod::none);
    for (const std::uint32_t t : bodies.surface(i).sample_texels()) {
      ASSERT_EQ(nearest.body[t], 1 - i);
      ASSERT_EQ(nearest.map.distance[t], map.distance[t]);
    }
  }
}

// Both bodies as one mesh: what it says of itself follows from what the two say of themselves and each other.
void expect_self_proximity(const Body& a, const Body& b, bool intersect, double separation,
                           double tolerance) {
  const auto apart = [](const Mesh& mesh) {
    const std::optional<BoundedLength> length = SelfProximityQuery(mesh).separation();
    return length ? length->value : std::numeric_limits<double>::infinity();
  };
  const Mesh both = joined(a.mesh, b.mesh);
  ASSERT_EQ(is_embedded(Sites(both)), !intersect && is_embedded(Sites(a.mesh)) && is_embedded(Sites(b.mesh)));
  const double least = std::min({apart(a.mesh), apart(b.mesh), separation});
  ASSERT_NEAR(apart(both), least, tolerance);
  for (const double margin : {0.0, 2 * least}) {
    SelfProximityQuery self(both);
    ASSERT_EQ(self.contacts(margin).empty(), least > margin) << "margin " << margin << ", least " << least;
  }
}

void check(const Body& a, const Body& b) {
  const double tolerance = 1e-6 * scene_diagonal(a.mesh, b.mesh);
  expect_map_signs(a, b, tolerance);
  if (testing::Test::HasFatalFailure()) return;

  const bool intersect = surfaces_intersect(a.mesh, b.mesh);
  const bool collide = intersect || contains_vertex(a, b.mesh) || contains_vertex(b, a.mesh);
  ProximityQuery query(a.mesh, b.mesh);
  const BoundedLength separation = query.separation();
  const std::optional<BoundedLength> depth = query.penetration_depth();

  ASSERT_EQ(query.colliding(), collide);
  ASSERT_EQ(separation.certainty, Certainty::exact);
  if (intersect) {
    ASSERT_EQ(separation.value, 0);
    ASSERT_EQ(separation.upper, 0);
  } else {
    ASSERT_GT(separation.upper, 0);
  }
  ASSERT_EQ(depth.has_value(), a.solid || b.solid);
  if (depth) {
    ASSERT_LE(depth->lower, depth->value + tolerance);
    ASSERT_LE(depth->value, depth->upper + tolerance);
    if (!collide) {
      ASSERT_EQ(depth->upper, 0);
    }
    double least = 0;
    if (a.solid) least = std::max(least, depth_by_faces(a, b.mesh));
    if (b.solid) least = std::max(least, depth_by_faces(b, a.mesh));
    ASSERT_GE(depth->upper, least - tolerance);
    for (const Contact& contact : query.contacts()) {
      ASSERT_LE(contact.depth, depth->upper);
      if (contact.depth > tolerance) {
        ASSERT_TRUE(collide);
      }
    }
  }

  MultiBodyQuery bodies(with_atlases(std::vector{a.mesh, b.mesh}, kResolution));
  ASSERT_EQ(bodies.separations().size(), 1u);
  const PairSeparation& pair = bodies.separations()[0];
  ASSERT_EQ(pair.colliding, collide);
  ASSERT_EQ(pair.separation.value, separation.value);
  ASSERT_EQ(bodies.colliding().size(), collide ? 1u : 0u);
  ASSERT_EQ(bodies.penetration_depths().size(), collide && depth ? 1u : 0u);
  for (const PairDepth& pair_depth : bodies.penetration_depths()) {
    ASSERT_EQ(pair_depth.penetration_depth.value, depth->value);
    ASSERT_EQ(pair_depth.penetration_depth.upper, depth->upper);
  }
  expect_nearest_maps(a, b, bodies);
  expect_self_proximity(a, b, intersect, separation.value, tolerance);
}

TEST(Consistency, OfAllAnswersOnRandomScenes) {
  const auto asked = [](const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : otherwise;
  };
  const int first = asked("SDM_FIRST_SCENE", 0), count = asked("SDM_SCENES", 1000);
  ASSERT_GT(count, 0);
  int colliding = 0;
  for (int i = first; i < first + count; ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    Scenes scenes(static_cast<unsigned>(i));
    const Body a = scenes.body(), b = scenes.body();
    check(a, b);
    if (HasFatalFailure()) return;
    colliding += surfaces_intersect(a.mesh, b.mesh);
  }
  if (count < 100) return;
  EXPECT_GT(colliding, count / 10);
  EXPECT_LT(colliding, count - count / 50);
}

}  // namespace
}  // namespace sdm::test

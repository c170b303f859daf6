// Proximity queries against known results, against maps of all samples, and against themselves.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "geometry/vec.h"
#include "sites/sites_data.h"
#include "support/allocations.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

void expect_holds(const BoundedLength& length, double truth, double slack) {
  EXPECT_LE(length.lower, truth + slack);
  EXPECT_GE(length.upper, truth - slack);
  EXPECT_LE(length.lower, length.value);
  EXPECT_LE(length.value, length.upper);
}

void expect_witness(const BoundedLength& length) {
  ASSERT_TRUE(length.witness);
  EXPECT_NEAR(norm((*length.witness)[1] - (*length.witness)[0]), length.value, 1e-6);
}

// Faces 0.3 apart, or through each other by 0.3.
TEST(Proximity, Cubes) {
  for (const double gap : {0.3, 2.0, 40.0}) {
    ProximityQuery query(cube(), moved(cube(), {2 + gap, 0.1, 0.2}));
    EXPECT_EQ(query.separation().certainty, Certainty::exact);
    EXPECT_NEAR(query.separation().value, gap, 1e-12);
    expect_witness(query.separation());
    EXPECT_FALSE(query.colliding());
    ASSERT_TRUE(query.penetration_depth());
    EXPECT_EQ(query.penetration_depth()->value, 0);
    EXPECT_EQ(query.penetration_depth()->upper, 0);
    EXPECT_TRUE(query.contacts().empty());
  }
  ProximityQuery query(cube(), moved(cube(), {1.7, 0.1, 0.2}));
  EXPECT_TRUE(query.colliding());
  expect_holds(*query.penetration_depth(), 0.3, 1e-9);
  EXPECT_NEAR(query.penetration_depth()->value, 0.3, 1e-5);
  expect_witness(*query.penetration_depth());
  EXPECT_EQ(query.separation().lower, 0);
}

// The deepest point of either of two unit spheres at the distance 1.5 is 0.5 below the other.
TEST(Proximity, DepthOfSpheresConverges) {
  double error = 1;
  for (const int level : {1, 2, 3, 4}) {
    ProximityQuery query(sphere(level), moved(sphere(level), {0.9, 1.2, 0}));
    ASSERT_TRUE(query.penetration_depth());
    const BoundedLength depth = *query.penetration_depth();
    EXPECT_EQ(depth.certainty, Certainty::bounded);
    EXPECT_GT(depth.lower, 0.2);
    expect_witness(depth);
    const double now = std::max(std::abs(depth.lower - 0.5), std::abs(depth.upper - 0.5));
    EXPECT_LT(now, 0.9 * error) << level;
    error = now;
  }
  EXPECT_LT(error, 0.01);
}

// A ball of radius 0.4 in the tube of radius 1 of a torus, 0.3 off the circle in its middle, which goes
// through the ball's surface: the wall is 1 away there, and 0.3 at the nearest.
TEST(Proximity, DepthInATorus) {
  double error = 1;
  for (const std::uint32_t n : {24u, 48u, 96u}) {
    Mesh ball = sphere(3);
    for (Vec3& p : ball.positions) p = 0.4 * p + Vec3{2.3, 0, 0};
    ProximityQuery query(torus(2 * n, n), ball);
    const BoundedLength depth = *query.penetration_depth();
    EXPECT_TRUE(query.colliding());
    expect_holds(depth, 1, 0.04 * 24 / n);
    const double now = std::max(std::abs(depth.upper - 1), std::abs(depth.lower - 1));
    EXPECT_LT(now, 0.7 * error);
    error = now;
    EXPECT_NEAR(query.separation().value, 0.3, 0.04 * 24 / n);
  }
}

// The maps' samples are points of the surfaces, and every other point is near one of them.
TEST(Proximity, AgreesWithCompleteMaps) {
  const Mesh bunny = load("bunny.obj", "fit");
  for (const char* placement :
       {"fit,translate:0.8:0:0", "fit,translate:0.1:0:0", "fit,scale:0.2", "fit,translate:0.45:0:0"}) {
    SCOPED_TRACE(placement);
    const Mesh armadillo = load("armadillo.off", placement);
    const AtlasOptions atlas{.resolution = 256};
    ProximityQuery query(Shape(bunny, atlas), Shape(armadillo, atlas));
    const double tolerance = 2e-6 * scene_diagonal(bunny, armadillo);
    double least = 1e300, lower = 1e300;  // bounds on the separation
    double deepest = 0, upper = 0;        // and on the depth
    for (int b = 0; b < 2; ++b) {
      const Surface& surface = query.surface(b);
      const DistanceMap map = compute_map(surface, query.sites(1 - b));
      const SamplingBound bound(surface);
      for (std::size_t i = 0; i < surface.sample_texels().size(); ++i) {
        const double d = map.distance[surface.sample_texels()[i]];
        least = std::min(least, std::abs(d));
        lower = std::min(lower, std::abs(d) - bound.sample_radii()[i]);
        deepest = std::max(deepest, -d);
        upper = std::max(upper, bound.sample_radii()[i] - d);
      }
    }
    EXPECT_LE(query.separation().value, least + tolerance);
    EXPECT_GE(query.separation().value, lower - tolerance);
    const BoundedLength& depth = *query.penetration_depth();
    EXPECT_GE(depth.upper, deepest - tolerance);
    if (!query.colliding()) continue;
    EXPECT_LE(depth.lower, upper + tolerance);
    EXPECT_LE(depth.upper - depth.lower, 1e-3 * diagonal(bounds(bunny)) + tolerance);
    expect_witness(depth);
  }
}

// The bounds are as narrow as asked, and consistent. The truth is not known, but between the largest lower
// bound and each upper one.
TEST(Proximity, DepthIsAsPreciseAsAsked) {
  const Mesh a = load("cow.off", "fit"), b = load("head.off", "fit,translate:0.4:0.1:0");
  const double tolerance = 2e-6 * scene_diagonal(a, b);
  double deepest = 0, shallowest = 1e300;
  for (const double precision : {0.1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    SCOPED_TRACE(precision);
    ProximityQuery query(a, b, {.depth_precision = precision});
    const BoundedLength& depth = *query.penetration_depth();
    EXPECT_EQ(depth.certainty, Certainty::bounded);
    EXPECT_LE(depth.upper - depth.lower, precision + 2 * tolerance);
    EXPECT_LE(depth.lower, depth.value);
    EXPECT_LE(depth.value, depth.upper);
    expect_witness(depth);
    deepest = std::max(deepest, depth.lower);
    shallowest = std::min(shallowest, depth.upper);
    EXPECT_LE(deepest, shallowest);
  }
  EXPECT_LT(shallowest - deepest, 1e-4);
  for (const double bad : {-1.0, 0.0, std::nan("")})
    EXPECT_THROW(ProximityQuery(a, b, {.depth_precision = bad}), Error);
}

/// Each triangle divided into four, this many times.
Mesh divided(Mesh mesh, int times) {
  for (; times > 0; --times) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
    Mesh finer{mesh.positions, {}, {}};
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] = middles.emplace(std::array{std::min(a, b), std::max(a, b)},
                                               static_cast<std::uint32_t>(finer.positions.size()));
      if (added) finer.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      return at->second;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t d = middle(a, b), e = middle(b, c), f = middle(c, a);
      for (const Triangle& t : {Triangle{a, d, f}, {d, b, e}, {f, e, c}, {d, e, f}})
        finer.triangles.push_back(t);
    }
    mesh = finer;
  }
  return mesh;
}

// Surfaces that are parallel and equally deep everywhere: finely divided ones, too.
TEST(Proximity, DepthOfParallelFaces) {
  for (const int times : {0, 5}) {
    const Mesh box = divided(cube(), times);
    ProximityQuery query(box, moved(box, {1.7, 0.01, 0.02}), {.depth_precision = 1e-4});
    expect_holds(*query.penetration_depth(), 0.3, 1e-9);
    EXPECT_LT(query.penetration_depth()->upper - query.penetration_depth()->lower, 1.2e-4);
  }
}

TEST(Proximity, OpenMeshesHaveNoInside) {
  const Mesh open = band(30, false);
  ProximityQuery query(open, moved(open, {0.5, 0, 0.2}));
  EXPECT_FALSE(query.penetration_depth());
  EXPECT_EQ(query.separation().value, 0);
  EXPECT_EQ(query.separation().certainty, Certainty::exact);
  EXPECT_TRUE(query.colliding());
  // Of a pair with one solid the other's surface can be inside of it.
  ProximityQuery solid(cube(), moved(open, {0, 0, 0.8}));
  ASSERT_TRUE(solid.penetration_depth());
}

// The box around a turned body is larger than its own.
TEST(Proximity, DepthOfTurnedBodiesIsAsPreciseAsPromised) {
  const Mesh torus_like = torus(24, 12), ball = sphere(2);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    ProximityQuery query(torus_like, ball);
    query.set_pose(0, Transform::rotation({20.0 * i, 33.0 * i, 50.0 * i}));
    query.set_pose(1, Transform::translation({0.5, 0.3, 0.1 * i}) *
                          Transform::rotation({40.0 * i, 15.0 * i, 5}) * Transform::scaling(0.8));
    if (!query.colliding()) continue;
    const BoundedLength& depth = *query.penetration_depth();
    const double smaller = std::min(diagonal(bounds(torus_like)), 0.8 * diagonal(bounds(ball)));
    EXPECT_LE(depth.upper - depth.lower, 1e-3 * smaller);
    EXPECT_LE(query.contacts().front().depth, depth.upper);
  }
}

void expect_depth(const Mesh& a, const Mesh& b, double truth) {
  for (const bool swapped : {false, true}) {
    ProximityQuery query(swapped ? b : a, swapped ? a : b);
    const BoundedLength depth = *query.penetration_depth();
    expect_holds(depth, truth, 0);
    EXPECT_LE(depth.upper - depth.lower, 1e-3 * std::min(diagonal(bounds(a)), diagonal(bounds(b))));
    for (const Contact& c : query.contacts()) EXPECT_LE(c.depth, depth.upper);
  }
}

// No part of such a shell is boundary: neither a point, at the deepest point of an edge, nor a sheet.
TEST(Proximity, ShellsWithoutAreaHaveNoBoundary) {
  const Mesh at_centre = joined(box({0, 0, 0}, {4, 4, 4}), box({2, 2, 2}, {2, 2, 2}));
  expect_depth(at_centre, box({-2, 0, 2}, {5, 2, 9}), 2);
  const Mesh sheet =
      joined(joined(box({0, 1, 2}, {3, 5, 4}), box({0, 1, 3}, {2, 3, 5})), box({2, 0, 3}, {2, 4, 4}));
  expect_depth(sheet, joined(box({2, 2, 1}, {3, 3, 2}), box({1, 2, 1}, {2, 3, 3})), 1);
}

// Two cubes, [0, 1]³ and [0.5, 1.5] × [0.25, 0.75]², overlap; a small one lies inside the first. The walls of
// the second one inside of the first are nearer to it than any part of the boundary.
TEST(Proximity, OverlappingShellsAreOneSolid) {
  const Mesh two = joined(box({0, 0, 0}, {1, 1, 1}), box({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75}));
  struct Case {
    Vec3 lo, hi;
    double depth;  // of the deepest point of the surface
  };
  for (const auto& [lo, hi, depth] :
       {Case{{0.4, 0.45, 0.45}, {0.45, 0.5, 0.5}, 0.45}, Case{{1.2, 0.45, 0.45}, {1.25, 0.55, 0.55}, 0.25}}) {
    SCOPED_TRACE(depth);
    for (const bool swapped : {false, true}) {
      ProximityQuery query(swapped ? two : box(lo, hi), swapped ? box(lo, hi) : two);
      EXPECT_TRUE(query.colliding());
      const BoundedLength found = *query.penetration_depth();
      EXPECT_LE(found.lower, depth);
      EXPECT_GE(found.upper, depth);
      EXPECT_LT(found.upper - found.lower, 0.01);
      ASSERT_FALSE(query.contacts().empty());
      // The deepest point lies in a face, its corners are up to 0.05 nearer to the boundary.
      EXPECT_LE(query.contacts().front().depth, depth + 1e-6);
      EXPECT_GE(query.contacts().front().depth, depth - 0.051);
    }
  }
}
// Regression: the separation of bodies that intersect was that of the nearest samples.
TEST(Proximity, SeparationOfIntersectingBodiesIsZero) {
  ProximityQuery query(sphere(3), moved(sphere(3), {0.9, 0.1, 0.2}));
  EXPECT_TRUE(query.colliding());
  EXPECT_EQ(query.separation().value, 0);
  EXPECT_EQ(query.separation().upper, 0);
  EXPECT_EQ(query.separation().certainty, Certainty::exact);
}

// Completely inside, without contact.
TEST(Proximity, NestedMeshesCollide) {
  Mesh inner = cube(0.5);
  for (const bool swapped : {false, true}) {
    ProximityQuery query(swapped ? inner : cube(), swapped ? cube() : inner);
    EXPECT_TRUE(query.colliding());
    EXPECT_NEAR(query.separation().value, 0.5, 1e-12);
    expect_holds(*query.penetration_depth(), 0.5, 1e-9);
  }
}

// Two cubes with their edges parallel, overlapping by 0.3 along x: contacts push O1 to the left.
TEST(Contacts, OfCubesPushThemApart) {
  ProximityQuery query(cube(), moved(cube(), {1.7, 0, 0}));
  ASSERT_FALSE(query.contacts().empty());
  std::size_t along = 0;
  for (const Contact& c : query.contacts()) {
    EXPECT_NEAR(norm(c.normal), 1, 1e-9);
    EXPECT_GE(c.depth, 0);
    EXPECT_NEAR(norm(c.point2 - c.point1), c.depth, 1e-9);
    EXPECT_LE(norm(c.depth * c.normal - (c.point2 - c.point1)), 2e-5);
    EXPECT_EQ(c.patch, 0u);
    along += c.normal[0] < -0.999;
  }
  EXPECT_GE(along, 2u);  // a face of either cube at least
  EXPECT_LT(query.contacts()[0].normal[0], -0.999);
  EXPECT_NEAR(query.contacts()[0].depth, 0.3, 1e-5);
}

// Two spheres, a little apart, within the margin: contacts on the line between them.
TEST(Contacts, WithinTheMarginPointAlongTheLineOfCentres) {
  const Vec3 centre{1.5, 1.2, 0.9};  // 2.12 away
  const double distance = norm(centre);
  ProximityQuery query(sphere(4), moved(sphere(4), centre), {.contact_margin = distance - 2 + 0.02});
  ASSERT_FALSE(query.contacts().empty());
  EXPECT_FALSE(query.colliding());
  const Vec3 along = (-1 / distance) * centre;  // pushes O1 off O2
  for (const Contact& c : query.contacts()) {
    EXPECT_LE(c.depth, -(distance - 2) + 0.01);
    EXPECT_GE(c.depth, -(distance - 2) - 0.02);
    EXPECT_GT(dot(c.normal, along), 0.9);
  }
  // The deepest sample is within the covering radius R of the line: the normal turns by less than 2 R /
  // distance of centres, and by the bend of a face.
  EXPECT_GT(dot(query.contacts()[0].normal, along), std::cos(0.1));
}

// From a cube inside a ball whose faces are flat, up to h from the round one: a point at the radius ρ has its
// closest point q within 1 − ρ, and |q| ≥ 1 − h. For the angle θ between q − p and the radius, as |q|² = ρ² +
// d² + 2 ρ d cos θ, that says cos θ ≥ 1 − (2h − h²) / (2 ρ (1 − ρ)).
TEST(Contacts, OfABallPointAlongItsRadius) {
  double steepest = 1;
  for (const int level : {2, 3, 4, 5}) {
    const Mesh ball = sphere(level);
    double h = 0;
    for (const auto& [i, j, k] : ball.triangles) {
      const Vec3 &a = ball.positions[i], &b = ball.positions[j], &c = ball.positions[k];
      h = std::max(h, 1 - dot(normalized(cross(b - a, c - a)), a));
    }
    ProximityQuery query(ball, moved(cube(0.3), {0.3, 0.1, 0.2}));
    std::size_t corners = 0;
    double least = 1;
    for (const Contact& c : query.contacts()) {
      const double radius = norm(c.point2);
      EXPECT_NEAR(norm(c.normal), 1, 1e-9);
      if (!(c.depth > 0 && radius < 1 - 2 * h)) continue;
      ++corners;
      // The ball is pushed so that its wall passes the cube where it is nearest.
      const double cosine = dot(c.normal, (-1 / radius) * c.point2);
      EXPECT_GE(cosine, 1 - (2 * h - h * h) / (2 * radius * (1 - radius)) - 1e-6) << level;
      least = std::min(least, cosine);
    }
    EXPECT_GE(corners, 8u);
    EXPECT_LT(1 - least, 1.01 * steepest);
    steepest = 1 - least;
  }
  EXPECT_LT(steepest, 0.01);
}

// Three balls on a plate.
TEST(Contacts, FormPatches) {
  Mesh balls, plate = cube();
  for (Vec3& p : plate.positions) p = {4 * p[0], 4 * p[1], 0.5 * p[2] - 0.5};
  for (int i = 0; i < 3; ++i)
    balls = joined(balls, moved(sphere(3), {2.5 * (i - 1), 0.3 * i, 0.95 - 0.01 * i}));
  ProximityQuery query(balls, plate);
  std::set<std::uint32_t> patches;
  double last = 1;
  for (const Contact& c : query.contacts()) {
    if (patches.insert(c.patch).second) {
      EXPECT_LE(c.depth, last);  // patches by their deepest
      EXPECT_EQ(c.patch + 1, patches.size());
      EXPECT_GT(c.normal[2], 0.99);  // upwards: O1 is pushed off the plate
      last = c.depth;
    }
    EXPECT_LE(c.depth, last);
  }
  EXPECT_EQ(patches.size(), 3u);
  EXPECT_NEAR(query.contacts()[0].point1[0], 2.5, 0.2);
}

TEST(Contacts, FlipWhenTheBodiesAreSwapped) {
  const Mesh a = load("cow.off", "fit"), b = load("head.off", "fit,translate:0.5:0.1:0");
  ProximityQuery ab(a, b), ba(b, a);
  ASSERT_FALSE(ab.contacts().empty());
  ASSERT_EQ(ab.contacts().size(), ba.contacts().size());
  const auto key = [](const Vec3& p) { return std::tuple(p[0], p[1], p[2]); };
  std::vector<Contact> x(ab.contacts().begin(), ab.contacts().end()),
      y(ba.contacts().begin(), ba.contacts().end());
  std::ranges::sort(x, {}, [&](const Contact& c) { return std::pair(key(c.point1), key(c.point2)); });
  std::ranges::sort(y, {}, [&](const Contact& c) { return std::pair(key(c.point2), key(c.point1)); });
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(x[i].point1, y[i].point2);
    EXPECT_EQ(x[i].point2, y[i].point1);
    EXPECT_EQ(x[i].depth, y[i].depth);
    EXPECT_EQ(x[i].normal, -y[i].normal);
  }
  EXPECT_EQ(ab.separation().value, ba.separation().value);
  EXPECT_EQ(ab.penetration_depth()->value, ba.penetration_depth()->value);
}

struct Answers {
  double separation, lower, depth, upper;
  bool colliding;
  std::vector<double> depths;
  bool operator==(const Answers&) const = default;
};

Answers answers(ProximityQuery& query) {
  Answers a{query.separation().value,         query.separation().lower, query.penetration_depth()->value,
            query.penetration_depth()->upper, query.colliding(),        {}};
  for (const Contact& c : query.contacts()) a.depths.push_back(c.depth);
  return a;
}

TEST(ProximityRefit, ReturnsToTheSameBits) {
  const Mesh a = load("cow.off", "fit"), b = load("head.off", "fit,translate:0.5:0.1:0");
  ProximityQuery query(a, b);
  const Answers first = answers(query);
  query.refit(a.positions, b.positions);
  EXPECT_EQ(answers(query), first);
  const std::vector<Vec3> away = moved(b, {3, 0, 0}).positions;
  query.refit({}, away);
  EXPECT_FALSE(query.colliding());
  EXPECT_GT(query.separation().lower, 1);
  EXPECT_TRUE(query.contacts().empty());
  // Texels that have moved away come back but for rounding; from then on to the bit.
  query.refit({}, b.positions);
  const Answers back = answers(query);
  EXPECT_NEAR(back.separation, first.separation, 1e-6);
  EXPECT_NEAR(back.depth, first.depth, 1e-6);
  EXPECT_EQ(back.depths.size(), first.depths.size());
  query.refit({}, away);
  query.refit({}, b.positions);
  EXPECT_EQ(answers(query), back);
}

// A rigid motion of both bodies changes results only by rounding.
TEST(ProximityRefit, RigidMotion) {
  const Mesh a = load("cow.off", "fit"), b = load("head.off", "fit,translate:0.5:0.1:0");
  ProximityQuery query(a, b);
  const Answers first = answers(query);
  query.refit(placed(a, "rotate:20:50:-70,translate:2:3:4").positions,
              placed(b, "rotate:20:50:-70,translate:2:3:4").positions);
  EXPECT_NEAR(query.separation().value, first.separation, 2e-5);
  EXPECT_NEAR(query.penetration_depth()->value, first.depth, 2e-5);
  EXPECT_EQ(query.colliding(), first.colliding);
}

/// Fails if refits and queries still allocate memory when bodies repeat their poses.
void expect_steady(const Mesh& a, const Mesh& b) {
  const std::array frames{b.positions, moved(b, {0.1, 0, 0}).positions, moved(b, {3, 0, 0}).positions};
  ProximityQuery query(a, b, {.contact_margin = 0.05});
  const auto taken = [&] {
    const std::size_t before = allocations();
    for (const std::vector<Vec3>& frame : frames) {
      query.refit(a.positions, frame);
      (void)query.separation();
      (void)query.colliding();
      (void)query.penetration_depth();
      (void)query.contacts();
    }
    return allocations() - before;
  };
  EXPECT_GT(taken(), 0u);
  EXPECT_EQ(taken(), 0u);
}

TEST(ProximityRefit, AllocatesNothingAfterTheFirstFrames) {
  const ThreadLimit alone(1);  // threads that join later allocate memory of their own
  const Mesh sliver = placed(wedge(0.5), "rotate:31:127:201");
  ASSERT_GT(std::ranges::count(internals(Sites(sliver)).sliver, 1), 0);
  const Mesh hollow = joined(sphere(3), placed(sphere(3), "scale:0.5"));
  ASSERT_EQ(internals(Sites(hollow)).shells.size(), 2u);
  expect_steady(torus(60, 30), moved(sphere(4), {2.5, 0, 0.3}));
  expect_steady(load("cow.off", "fit"), load("head.off", "fit,translate:0.5:0.1:0"));
  expect_steady(sliver, moved(sliver, {0.2, 0.1, 0}));
  expect_steady(hollow, moved(hollow, {0.7, 0, 0}));
}

TEST(ProximityRefit, RejectsMismatchedPositions) {
  ProximityQuery query(cube(), moved(cube(), {3, 0, 0}));
  const double before = query.separation().value;
  const std::vector<Vec3> few(3), nan(8, Vec3{std::nan(""), 0, 0}), good = moved(cube(), {9, 0, 0}).positions;
  EXPECT_THROW(query.refit(few, {}), Error);
  EXPECT_THROW(query.refit(good, nan), Error);
  EXPECT_EQ(query.separation().value, before);
  EXPECT_THROW(ProximityQuery(cube(), cube(), {.contact_margin = -1}), Error);
  EXPECT_THROW(ProximityQuery(cube(), cube(), {.contact_margin = std::nan("")}), Error);
}

}  // namespace
}  // namespace sdm::test

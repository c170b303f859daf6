// Primitive solids and margins: against closed forms, and against finely divided meshes.
#include <gmock/gmock.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "support/shapes.h"

namespace sdm {
namespace {

constexpr double kTolerance = 1e-9;

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Vec3 vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
  Transform rotation() {
    std::normal_distribution<double> normal;
    return Transform::quaternion({normal(random_), normal(random_), normal(random_), normal(random_)});
  }
  Transform pose(double size) { return Transform::translation(vector(size)) * rotation(); }

 private:
  std::mt19937 random_;
};

Vec3 image_of(const Transform& pose, const Vec3& p) {
  Vec3 result;
  for (int i = 0; i < 3; ++i)
    result[i] = pose.rows[i][0] * p[0] + pose.rows[i][1] * p[1] + pose.rows[i][2] * p[2] + pose.rows[i][3];
  return result;
}
Transform inverse_of(const Transform& pose) {  // of a rotation and a translation
  Transform result;
  for (int i = 0; i < 3; ++i) {
    result.rows[i][3] = 0;
    for (int j = 0; j < 3; ++j) {
      result.rows[i][j] = pose.rows[j][i];
      result.rows[i][3] -= pose.rows[j][i] * pose.rows[j][3];
    }
  }
  return result;
}

ProximityQuery query(const Shape& o1, const Transform& pose1, const Shape& o2, const Transform& pose2,
                     const ProximityOptions& options = {}) {
  ProximityQuery result(o1, o2, options);
  result.set_pose(0, pose1);
  result.set_pose(1, pose2);
  return result;
}

// What holds of any two convex bodies with a signed distance.
void expect_distance(ProximityQuery& q, double distance, double tolerance = kTolerance) {
  EXPECT_EQ(q.colliding(), distance <= 0) << distance;
  if (distance > 0) {
    EXPECT_NEAR(q.separation().value, distance, tolerance);
    EXPECT_EQ(q.separation().certainty, Certainty::exact);
    ASSERT_TRUE(q.separation().witness);
    const auto& [p, r] = *q.separation().witness;
    EXPECT_NEAR(norm(p - r), distance, tolerance);
    EXPECT_EQ(q.penetration_depth()->value, 0);
    EXPECT_EQ(q.separating_translation().value, 0);
    return;
  }
  const SeparatingTranslation out = q.separating_translation();
  EXPECT_EQ(out.certainty, Certainty::exact);
  EXPECT_NEAR(out.value, -distance, 1e-6 + tolerance);
  EXPECT_LE(out.lower, -distance + tolerance);
  const BoundedLength depth = *q.penetration_depth();
  EXPECT_LE(depth.lower, depth.upper);
  EXPECT_LE(depth.upper, -distance + tolerance);
  const Transform before = q.pose(0);
  q.set_pose(0, Transform::translation(out.translation) * before);
  EXPECT_FALSE(q.colliding());
  q.set_pose(0, before);
}

double to_box(const Vec3& p, const Vec3& half) {  // signed
  Vec3 out;
  double inside = -kInfinity;
  for (int k = 0; k < 3; ++k) {
    inside = std::max(inside, std::abs(p[k]) - half[k]);
    out[k] = std::max(0.0, std::abs(p[k]) - half[k]);
  }
  return inside > 0 ? norm(out) : inside;
}
double to_cylinder(const Vec3& p, double radius, double length) {
  const double beside = std::hypot(p[0], p[1]) - radius, above = std::abs(p[2]) - length / 2;
  return beside > 0 && above > 0 ? std::hypot(beside, above) : std::max(beside, above);
}
double between_segments(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // By ternary search over the first, of the convex distance from the second.
  const auto at = [&](double t) {
    const Vec3 p = a + t * (b - a);
    return norm(p - closest_on_segment(p, c, d));
  };
  double low = 0, high = 1;
  for (int i = 0; i < 200; ++i) {
    const double third = (high - low) / 3;
    (at(low + third) < at(high - third) ? high : low) =
        at(low + third) < at(high - third) ? high - third : low + third;
  }
  return at(0.5 * (low + high));
}

TEST(Primitives, HaveNoTriangles) {
  for (const Shape& shape :
       {Shape::sphere(1), Shape::capsule(1, 2), Shape::cylinder(1, 2), Shape::half_space({0, 0, 1})}) {
    EXPECT_FALSE(shape.has_mesh());
    EXPECT_TRUE(shape.convex());
    EXPECT_THROW((void)shape.sites(), Error);
    EXPECT_THROW((void)shape.surface(), Error);
    EXPECT_THROW(shape.store([](std::span<const std::byte>) {}), Error);
  }
  EXPECT_EQ(Shape::box({1, 2, 3}).sites().mesh().positions.size(), 8u);
  EXPECT_TRUE(Shape::box({1, 2, 3}).convex());
}

TEST(Primitives, RefuseSizesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = kInfinity;
  for (const double size : {0.0, -1.0, nan, infinite, 1e-31, 1e31}) {
    EXPECT_THROW((void)Shape::sphere(size), Error) << size;
    EXPECT_THROW((void)Shape::capsule(size, 1), Error) << size;
    EXPECT_THROW((void)Shape::capsule(1, size), Error) << size;
    EXPECT_THROW((void)Shape::cylinder(size, 1), Error) << size;
    EXPECT_THROW((void)Shape::cylinder(1, size), Error) << size;
    EXPECT_THROW((void)Shape::box({1, size, 1}), Error) << size;
    EXPECT_THROW((void)Shape::sphere(1).with_margin(size), Error) << size;
  }
  EXPECT_THROW((void)Shape::half_space({0, 0, 0}), Error);
  EXPECT_THROW((void)Shape::half_space({nan, 0, 0}), Error);
  EXPECT_THROW((void)Shape::half_space({0, 0, 1}, infinite), Error);
  EXPECT_THROW((void)Shape(test::torus(16, 8)).with_margin(0.1), Error);
  try {
    (void)Shape::sphere(-1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), testing::HasSubstr("radius of the sphere"));
  }
}

TEST(Primitives, AreNotDeformed) {
  ProximityQuery q(Shape::sphere(1), Shape::box({1, 1, 1}));
  const std::vector<Vec3> positions(3);
  EXPECT_THROW(q.refit(positions, {}), Error);
  ProximityQuery floors(Shape::half_space({0, 0, 1}), Shape::half_space({1, 0, 0}));
  EXPECT_THROW((void)floors.colliding(), Error);
}

TEST(Primitives, SphereAndSphere) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const double r = random(0.2, 2), s = random(0.2, 2);
    const Transform a = random.pose(1.5), b = random.pose(1.5);
    const double between = norm(image_of(a, {}) - image_of(b, {}));
    ProximityQuery q = query(Shape::sphere(r), a, Shape::sphere(s), b);
    expect_distance(q, between - r - s);
    if (between >= r + s) continue;
    EXPECT_NEAR(q.separation().value, std::max(0.0, std::abs(r - s) - between), kTolerance);
    // The deepest points are on the line of the centres.
    const double depth = std::max(s - std::abs(between - r), r - std::abs(between - s));
    EXPECT_EQ(q.penetration_depth()->certainty, Certainty::exact);
    EXPECT_NEAR(q.penetration_depth()->value, depth, kTolerance);
  }
}

TEST(Primitives, SphereAndBox) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const double r = random(0.1, 1.5);
    const Vec3 half{random(0.2, 1), random(0.2, 1), random(0.2, 1)};
    const Transform a = random.pose(1.2), b = random.pose(1.2);
    const Vec3 centre = image_of(inverse_of(b), image_of(a, {}));
    ProximityQuery q = query(Shape::sphere(r), a, Shape::box(2 * half), b);
    expect_distance(q, to_box(centre, half) - r);
  }
}

TEST(Primitives, CapsuleAndCapsule) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const double r = random(0.1, 1), s = random(0.1, 1), l = random(0.2, 3), m = random(0.2, 3);
    const Transform a = random.pose(2), b = random.pose(2);
    const double between = between_segments(image_of(a, {0, 0, -l / 2}), image_of(a, {0, 0, l / 2}),
                                            image_of(b, {0, 0, -m / 2}), image_of(b, {0, 0, m / 2}));
    ProximityQuery q = query(Shape::capsule(r, l), a, Shape::capsule(s, m), b);
    expect_distance(q, between - r - s, 1e-7);
  }
}

TEST(Primitives, SphereAndCylinder) {
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const double r = random(0.1, 1), s = random(0.2, 1), l = random(0.3, 3);
    const Transform a = random.pose(1.5), b = random.pose(1.5);
    const Vec3 centre = image_of(inverse_of(b), image_of(a, {}));
    ProximityQuery q = query(Shape::sphere(r), a, Shape::cylinder(s, l), b);
    expect_distance(q, to_cylinder(centre, s, l) - r);
  }
}

TEST(Primitives, AllAndAHalfSpace) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const double r = random(0.1, 1), l = random(0.2, 2), offset = random(-1, 1);
    const Vec3 n = random.vector(1), half{random(0.2, 1), random(0.2, 1), random(0.2, 1)};
    const Transform a = random.pose(2), b = random.pose(1);
    const Shape floor = Shape::half_space(n, offset);
    // In the frame of the half-space.
    const Transform local = inverse_of(b) * a;
    const Vec3 unit = normalized(n), z = image_of(local, {0, 0, 1}) - image_of(local, {});
    const double height = dot(unit, image_of(local, {})) - offset, along = std::abs(dot(unit, z));
    ProximityQuery sphere = query(Shape::sphere(r), a, floor, b);
    expect_distance(sphere, height - r);
    ProximityQuery capsule = query(Shape::capsule(r, l), a, floor, b);
    expect_distance(capsule, height - l / 2 * along - r);
    ProximityQuery cylinder = query(Shape::cylinder(r, l), a, floor, b);
    expect_distance(cylinder, height - l / 2 * along - r * std::sqrt(std::max(0.0, 1 - along * along)));
    double lowest = kInfinity;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{(corner & 1 ? 1 : -1) * half[0], (corner & 2 ? 1 : -1) * half[1],
                   (corner & 4 ? 1 : -1) * half[2]};
      lowest = std::min(lowest, dot(unit, image_of(local, p)) - offset);
    }
    ProximityQuery box = query(Shape::box(2 * half), a, floor, b);
    expect_distance(box, lowest);
    ProximityQuery swapped = query(floor, b, Shape::box(2 * half), a);
    expect_distance(swapped, lowest);
    const double separation = swapped.separation().value;
    EXPECT_EQ(box.separation().value, separation);
  }
}

Mesh hull_of(Mesh mesh) {
  for (std::uint32_t i = 2; i < mesh.positions.size(); ++i) mesh.triangles.push_back({i - 2, i - 1, i});
  return convex_hull(mesh);
}
// A cylinder is its own mesh, but for the sagitta of its division.
Mesh cylinder_mesh(double radius, double length, std::uint32_t sides) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i)
    for (const double z : {-length / 2, length / 2}) {
      const double angle = 2 * std::numbers::pi * i / sides;
      mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
  return hull_of(mesh);
}
Mesh capsule_mesh(double radius, double length, int levels) {
  Mesh mesh;
  for (const double z : {-length / 2, length / 2})
    for (const Vec3& p : test::sphere(levels).positions)
      mesh.positions.push_back(radius * normalized(p) + Vec3{0, 0, z});
  return hull_of(mesh);
}

struct Round {
  Shape exact, mesh;
  double sagitta;
};
std::vector<Round> round_shapes() {
  const double r = 0.7, l = 1.5;
  constexpr std::uint32_t kSides = 256;
  const double by_sides = r * (1 - std::cos(std::numbers::pi / kSides));
  std::vector<Round> shapes;
  shapes.push_back({Shape::cylinder(r, l), Shape(cylinder_mesh(r, l, kSides)), by_sides});
  // Of an icosphere of four levels: the edge of the icosahedron is seen at 63.4°.
  const double angle = 63.4 / 180 * std::numbers::pi / 16;
  const double by_levels = r * (1 - std::cos(angle));
  shapes.push_back({Shape::capsule(r, l), Shape(capsule_mesh(r, l, 4)), by_levels});
  shapes.push_back({Shape::sphere(r), Shape(capsule_mesh(r, 0, 4)), by_levels});
  return shapes;
}

// Moving each surface by its sagitta at most makes one pair the other.
TEST(Primitives, AreThoseOfFineMeshes) {
  Random random(6);
  std::vector<Round> shapes = round_shapes();
  const Mesh torus = test::torus(24, 12);
  shapes.push_back({Shape(torus), Shape(torus), 0});
  shapes.push_back({Shape::box({1, 1.4, 0.8}), Shape::box({1, 1.4, 0.8}), 0});
  int apart = 0, colliding = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      if (shapes[i].sagitta == 0 && shapes[j].sagitta == 0) continue;
      const double error = shapes[i].sagitta + shapes[j].sagitta + 1e-6;
      for (int k = 0; k < 12; ++k) {
        const Transform a = random.pose(1.6), b = random.pose(1.6);
        ProximityQuery exact = query(shapes[i].exact, a, shapes[j].exact, b);
        ProximityQuery fine = query(shapes[i].mesh, a, shapes[j].mesh, b);
        const std::string at = std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(k);
        EXPECT_NEAR(exact.separation().value, fine.separation().value, error) << at;
        EXPECT_TRUE(exact.colliding() || !fine.colliding()) << at << ": meshes are in their solids";
        if (exact.separation().value > 0) {
          apart += exact.colliding() ? 0 : 1;
          continue;
        }
        ++colliding;
        const BoundedLength depth = *exact.penetration_depth(), of_mesh = *fine.penetration_depth();
        EXPECT_LE(depth.lower, of_mesh.upper + error) << at;
        EXPECT_GE(depth.upper, of_mesh.lower - error) << at;
        const SeparatingTranslation out = exact.separating_translation(),
                                    out_of_mesh = fine.separating_translation();
        EXPECT_LE(out.lower, out_of_mesh.upper + error) << at;
        EXPECT_GE(out.upper, out_of_mesh.lower - error) << at;
        exact.set_pose(0, Transform::translation(out.translation) * a);
        EXPECT_FALSE(exact.colliding()) << at;
      }
    }
  EXPECT_GT(apart, 50);
  EXPECT_GT(colliding, 50);
}

// Along a cylinder's axis, rounding alone decides which point of its rim is farthest: a point that was not on
// the rim made bodies collide that are apart, and shortened the way out.
TEST(Primitives, SwappedAndScaledAgree) {
  const auto make = [](int kind, double s) {
    const Shape box = Shape::box({s, 0.6 * s, 0.8 * s});
    return kind == 0   ? Shape::sphere(0.5 * s)
           : kind == 1 ? Shape::capsule(0.3 * s, s)
           : kind == 2 ? Shape::cylinder(0.4 * s, s)
           : kind == 3 ? box
                       : box.with_margin(0.2 * s);
  };
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-1, 1);
  const auto turned = [&] {
    return Transform::quaternion({normal(random), normal(random), normal(random), normal(random)});
  };
  struct Answers {
    bool colliding;
    double separation, way_out;
  };
  for (int first = 0; first < 5; ++first)
    for (int second = 0; second < 5; ++second)
      for (int pose = 0; pose < 200; ++pose) {
        const Transform turn1 = turned(), turn2 = turned();
        const Vec3 at{offset(random), offset(random), offset(random)};
        const auto ask = [&](double size, bool swapped) {
          ProximityQuery query(make(swapped ? second : first, size), make(swapped ? first : second, size));
          query.set_pose(swapped ? 1 : 0, Transform::translation(size * at) * turn1);
          query.set_pose(swapped ? 0 : 1, turn2);
          return Answers{query.colliding(), query.separation().value / size,
                         query.separating_translation().value / size};
        };
        const Answers expected = ask(1, false);
        for (const Answers& found : {ask(1, true), ask(1e20, false)}) {
          ASSERT_EQ(found.colliding, expected.colliding) << first << " and " << second << ", pose " << pose;
          EXPECT_NEAR(found.separation, expected.separation, 1e-8) << first << " and " << second;
          EXPECT_NEAR(found.way_out, expected.way_out, 1e-8) << first << " and " << second;
        }
      }
}

TEST(Primitives, NestedInEachOther) {
  const auto separation = [](const Shape& o1, const Shape& o2, const Vec3& at) {
    ProximityQuery q = query(o1, Transform::translation(at), o2, {});
    EXPECT_TRUE(q.colliding());
    return q.separation().value;
  };
  EXPECT_NEAR(separation(Shape::sphere(1), Shape::sphere(3), {0.5, 0, 0}), 1.5, kTolerance);
  EXPECT_NEAR(separation(Shape::sphere(0.5), Shape::box({4, 4, 4}), {0.5, 0, 0}), 1, kTolerance);
  EXPECT_NEAR(separation(Shape::box({1, 1, 1}), Shape::sphere(3), {}), 3 - std::sqrt(0.75), kTolerance);
  EXPECT_NEAR(separation(Shape::sphere(0.5), Shape::cylinder(2, 3), {}), 1, kTolerance);
  EXPECT_NEAR(separation(Shape::capsule(0.5, 1), Shape::capsule(2, 1), {}), 1.5, kTolerance);
  EXPECT_NEAR(
      separation(Shape(test::torus(24, 12)), Shape::sphere(5), {}),
      5 -
          [] {
            double most = 0;
            for (const Vec3& p : test::torus(24, 12).positions) most = std::max(most, norm(p));
            return most;
          }(),
      kTolerance);
  EXPECT_NEAR(separation(Shape::sphere(1), Shape::half_space({0, 0, 1}), {0, 0, -5}), 4, kTolerance);
}

TEST(Primitives, MarginsOfConvexMeshes) {
  Random random(7);
  const Mesh mesh = test::sphere(1);
  const Shape plain(mesh), rounded = plain.with_margin(0.25), box = Shape::box({1, 2, 1.5});
  EXPECT_TRUE(rounded.has_mesh());
  EXPECT_EQ(rounded.margin(), 0.25);
  EXPECT_EQ(rounded.with_margin(0.25).margin(), 0.5);
  for (int i = 0; i < 200; ++i) {
    const Transform a = random.pose(2), b = random.pose(2);
    ProximityQuery without = query(plain, a, box, b), with = query(rounded, a, box, b);
    const double distance =
        without.colliding() ? -without.separating_translation().value : without.separation().value;
    expect_distance(with, distance - 0.25, 1e-6);
  }
  // A sphere with a margin is a larger one.
  ProximityQuery q =
      query(Shape::sphere(1).with_margin(0.5), Transform::translation({4, 0, 0}), Shape::sphere(1), {});
  expect_distance(q, 1.5);
}

TEST(Primitives, ContactsOfARestingBox) {
  const Shape floor = Shape::half_space({0, 0, 1});
  for (const double sunk : {0.0, 0.01, -0.005}) {
    ProximityQuery q = query(Shape::box({1, 2, 1}), Transform::translation({0.3, 0.2, 0.5 - sunk}), floor, {},
                             {.contact_margin = 0.01});
    const std::span<const Contact> contacts = q.contacts();
    ASSERT_EQ(contacts.size(), 4u) << sunk;
    for (const Contact& c : contacts) {
      EXPECT_NEAR(c.depth, sunk, kTolerance);
      EXPECT_NEAR(norm(c.normal - Vec3{0, 0, 1}), 0, kTolerance);
      EXPECT_NEAR(c.point2[2], 0, kTolerance);
      EXPECT_NE(c.on[0].face, kNone);
      EXPECT_EQ(c.on[1].face, kNone);
    }
  }
  ProximityQuery rounded =
      query(Shape::box({1, 2, 1}).with_margin(0.1), Transform::translation({0, 0, 0.59}), floor, {});
  ASSERT_EQ(rounded.contacts().size(), 4u);
  EXPECT_NEAR(rounded.contacts()[0].depth, 0.01, kTolerance);
}

TEST(Primitives, ContactsOfRoundShapes) {
  const Shape floor = Shape::half_space({0, 0, 1});
  const Shape table(test::moved(test::cube(10), {0, 0, 0}));
  const double top = [&] {
    double z = 0;
    for (const Vec3& p : table.sites().mesh().positions) z = std::max(z, p[2]);
    return z;
  }();
  const Transform lying = Transform::quaternion({std::sqrt(0.5), 0, std::sqrt(0.5), 0});
  const auto count = [&](const Shape& shape, const Transform& turned, double height) {
    std::vector<std::size_t> counts;
    for (const bool on_table : {false, true}) {
      ProximityQuery q =
          query(shape, Transform::translation({0.1, 0.2, height + (on_table ? top : 0)}) * turned,
                on_table ? table : floor, {});
      for (const Contact& c : q.contacts()) {
        EXPECT_NEAR(c.depth, 0.01, 1e-7);
        EXPECT_NEAR(norm(c.normal - Vec3{0, 0, 1}), 0, 1e-7);
        EXPECT_NEAR(norm(c.point2 - c.point1 - c.depth * c.normal), 0, 1e-7);
      }
      counts.push_back(q.contacts().size());
    }
    return counts;
  };
  EXPECT_THAT(count(Shape::sphere(0.5), {}, 0.49), testing::ElementsAre(1, 1));
  EXPECT_THAT(count(Shape::capsule(0.5, 1), lying, 0.49), testing::ElementsAre(2, 2));
  EXPECT_THAT(count(Shape::capsule(0.5, 1), {}, 0.99), testing::ElementsAre(1, 1));
  EXPECT_THAT(count(Shape::cylinder(0.5, 1), lying, 0.49), testing::ElementsAre(2, 2));
  EXPECT_THAT(count(Shape::cylinder(0.5, 1), {}, 0.49), testing::ElementsAre(8, 8));
}

// A plate with a groove is not convex: the sphere touches both sides.
TEST(Primitives, ContactsInAGroove) {
  Mesh groove;
  for (const double y : {-3.0, 3.0})
    for (const Vec2 p : {Vec2{-2, 2}, Vec2{0, 0}, Vec2{2, 2}}) groove.positions.push_back({p[0], y, p[1]});
  groove.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  const double r = 0.5;
  ProximityQuery q =
      query(Shape::sphere(r), Transform::translation({0, 0.1, std::sqrt(2) * (r - 0.01)}), Shape(groove), {});
  const std::span<const Contact> contacts = q.contacts();
  ASSERT_EQ(contacts.size(), 2u);
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.depth, 0.01, 1e-9);
    EXPECT_NEAR(std::abs(c.normal[0]), std::sqrt(0.5), 1e-9);
    EXPECT_GT(c.normal[2], 0);
  }
}

TEST(Primitives, AmongManyBodies) {
  Random random(8);
  const Mesh torus = test::torus(24, 12);
  std::vector<Shape> shapes{Shape::half_space({0, 0, 1}),
                            Shape::half_space({1, 0, 0}, -3),
                            Shape::sphere(0.5),
                            Shape::capsule(0.4, 1),
                            Shape::cylinder(0.5, 1),
                            Shape::box({1, 1, 1}),
                            Shape(torus),
                            Shape(test::sphere(2)).with_margin(0.2)};
  MultiBodyQuery bodies(shapes, {.contact_margin = 0.05});
  std::vector<Transform> poses(shapes.size());
  for (int frame = 0; frame < 5; ++frame) {
    for (std::size_t b = 2; b < shapes.size(); ++b) poses[b] = random.pose(2);
    bodies.set_poses(poses);
    std::size_t separations = 0, collisions = 0, depths = 0, contacts = 0, outs = 0;
    for (const PairSeparation& pair : bodies.separations()) {
      ++separations;
      ProximityQuery q =
          query(shapes[pair.first], poses[pair.first], shapes[pair.second], poses[pair.second]);
      EXPECT_EQ(pair.separation.value, q.separation().value);
      EXPECT_EQ(pair.colliding, q.colliding());
    }
    EXPECT_EQ(separations, shapes.size() * (shapes.size() - 1) / 2 - 1) << "all but both half-spaces";
    for (const BodyPair& pair : bodies.colliding()) {
      ++collisions;
      ProximityQuery q =
          query(shapes[pair.first], poses[pair.first], shapes[pair.second], poses[pair.second]);
      EXPECT_TRUE(q.colliding());
    }
    for (const PairDepth& pair : bodies.penetration_depths()) {
      ++depths;
      ProximityQuery q =
          query(shapes[pair.first], poses[pair.first], shapes[pair.second], poses[pair.second]);
      EXPECT_EQ(pair.penetration_depth.value, q.penetration_depth()->value);
    }
    for (const PairTranslation& pair : bodies.separating_translations()) {
      ++outs;
      ProximityQuery q =
          query(shapes[pair.first], poses[pair.first], shapes[pair.second], poses[pair.second]);
      EXPECT_EQ(pair.separating_translation.value, q.separating_translation().value);
    }
    for (const PairContacts& pair : bodies.contacts()) contacts += pair.contacts.size();
    EXPECT_EQ(depths, collisions);
    EXPECT_EQ(outs, collisions);
    EXPECT_GE(contacts, collisions);
    for (const PairContacts& pair : bodies.separating_contacts()) EXPECT_FALSE(pair.contacts.empty());
  }
}

TEST(Primitives, AsPartsOfCompounds) {
  // A dumbbell on a floor.
  const std::vector<BodyPart> dumbbell{
      {Shape::sphere(0.5), Transform::translation({-1, 0, 0})},
      {Shape::sphere(0.5), Transform::translation({1, 0, 0})},
      {Shape::cylinder(0.1, 2), Transform::quaternion({std::sqrt(0.5), 0, std::sqrt(0.5), 0})}};
  MultiBodyQuery bodies(std::vector<std::vector<BodyPart>>{dumbbell, {{Shape::half_space({0, 0, 1}), {}}}});
  bodies.set_pose(0, Transform::translation({0, 0, 0.7}));
  ASSERT_EQ(bodies.separations().size(), 1u);
  EXPECT_NEAR(bodies.separations()[0].separation.value, 0.2, kTolerance);
  bodies.set_pose(0, Transform::translation({0, 0, 0.4}));
  ASSERT_EQ(bodies.penetration_depths().size(), 1u);
  EXPECT_NEAR(bodies.penetration_depths()[0].penetration_depth.value, 0.1, kTolerance);
  ASSERT_EQ(bodies.separating_translations().size(), 1u);
  EXPECT_NEAR(bodies.separating_translations()[0].separating_translation.value, 0.1, 1e-5);
  std::size_t contacts = 0;
  for (const PairContacts& pair : bodies.contacts()) contacts += pair.contacts.size();
  EXPECT_EQ(contacts, 2u);
  EXPECT_THROW(MultiBodyQuery(std::vector<std::vector<BodyPart>>{
                   {{Shape::half_space({0, 0, 1}), {}}, {Shape::sphere(1), {}}}}),
               Error);
}

TEST(Primitives, ManyPoses) {
  Random random(9);
  std::vector<Transform> poses;
  for (int i = 0; i < 100; ++i) poses.push_back(random.pose(2));
  const Shape torus(test::torus(24, 12)), capsule = Shape::capsule(0.3, 1),
                                          floor = Shape::half_space({0, 0, 1}, -1);
  PoseQuery q(capsule, std::vector{torus, floor});
  const std::vector<std::uint8_t> hits = q.colliding(poses);
  const std::vector<double> separations = q.separations(poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ProximityQuery one = query(capsule, poses[i], torus, {}), other = query(capsule, poses[i], floor, {});
    EXPECT_EQ(hits[i] != 0, one.colliding() || other.colliding());
    EXPECT_EQ(separations[i], std::min(one.separation().value, other.separation().value));
  }
}

TEST(Primitives, TimesOfContactOfManyBodies) {
  const std::vector<Shape> shapes{Shape::half_space({0, 0, 1}), Shape::sphere(0.5), Shape::box({1, 1, 1}),
                                  Shape(test::torus(24, 12))};
  Random random(10);
  std::vector<Motion> motions(shapes.size());
  for (std::size_t b = 1; b < shapes.size(); ++b)
    motions[b] = {Transform::translation({6.0 * static_cast<double>(b), 0, 5}) * random.rotation(),
                  Transform::translation(random.vector(1)) * random.rotation()};
  const MultiBodyQuery bodies(shapes);
  const std::vector<PairTimeOfContact> found = bodies.time_of_contact(motions, 1e-5);
  EXPECT_GE(found.size(), 3u);
  for (const PairTimeOfContact& pair : found) {
    const TimeOfContact one = time_of_contact(shapes[pair.first], motions[pair.first], shapes[pair.second],
                                              motions[pair.second], 1e-5);
    EXPECT_EQ(pair.time_of_contact.time, one.time);
    EXPECT_TRUE(one.contact);
    ProximityQuery before(shapes[pair.first], shapes[pair.second]);
    for (const double part : {0.25, 0.5, 0.75, 0.999}) {
      before.set_pose(0, motions[pair.first].at(part * one.time, shapes[pair.first]));
      before.set_pose(1, motions[pair.second].at(part * one.time, shapes[pair.second]));
      EXPECT_FALSE(before.colliding()) << pair.first << " " << pair.second << " " << part;
    }
  }
}

TEST(Primitives, HaveNoMaps) {
  MultiBodyQuery bodies(
      std::vector<Shape>{Shape(test::cube(), AtlasOptions{}), Shape(test::cube(3)).with_margin(0.5)});
  EXPECT_THROW((void)bodies.nearest_map(0), Error);
  EXPECT_THROW((void)nearest_distances_at_vertices(bodies, 0, 10), Error);
}

TEST(Primitives, TimeOfContact) {
  const auto fall = [](const Shape& o1, const Shape& o2, const Transform& from, const Transform& to) {
    return time_of_contact(o1, {from, to}, o2, {}, 1e-6);
  };
  const Transform high = Transform::translation({0.2, 0.1, 3}), low = Transform::translation({0.2, 0.1, -1});
  const TimeOfContact sphere = fall(Shape::sphere(0.5), Shape::half_space({0, 0, 1}), high, low);
  EXPECT_TRUE(sphere.contact);
  EXPECT_NEAR(sphere.time, 2.5 / 4, 1e-6);
  EXPECT_NEAR(norm(*sphere.normal - Vec3{0, 0, 1}), 0, 1e-9);
  const TimeOfContact on_sphere = fall(Shape::sphere(0.5), Shape::sphere(1), high, low);
  EXPECT_NEAR(on_sphere.time, (3 - std::sqrt(2.25 - 0.05)) / 4, 1e-6);
  EXPECT_FALSE(fall(Shape::sphere(0.5), Shape::sphere(1), Transform::translation({1.6, 0, 3}),
                    Transform::translation({1.6, 0, -3}))
                   .contact);
  // A turning box, against the same motion over a large plate.
  Mesh plate = test::cube(1);
  for (Vec3& p : plate.positions) p = {20 * p[0], 20 * p[1], p[2] < 0 || p[2] == 0 ? -1.0 : 0.0};
  const Shape box = Shape::box({1, 2, 1});
  const Transform turned = Transform::translation({0, 0, -1}) * Transform::quaternion({0.8, 0.5, 0.2, 0.1});
  const TimeOfContact exact = fall(box, Shape::half_space({0, 0, 1}), high, turned);
  const TimeOfContact of_mesh = fall(box, Shape(plate), high, turned);
  EXPECT_TRUE(exact.contact);
  EXPECT_NEAR(exact.time, of_mesh.time, 1e-5);
  const TimeOfContact on_torus =
      fall(Shape::capsule(0.2, 1), Shape(test::torus(24, 12)), Transform::translation({1, 0, 3}),
           Transform::translation({1, 0, -1}) * Transform::quaternion({0.8, 0.5, 0.2, 0.1}));
  EXPECT_TRUE(on_torus.contact);
  EXPECT_LE(on_torus.separation, 1e-6);
}

}  // namespace
}  // namespace sdm

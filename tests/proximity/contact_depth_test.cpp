// Contacts against the penetration depth and against distances by brute force, over random poses: boxes,
// hulls and meshes, aligned, slightly tilted and turned in any way. The number of poses is 1000, or that of
// the environment variable SDM_POSES (see tests/long); SDM_FIRST_POSE is the first of them, to repeat one
// that failed.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include "geometry/boxes.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// The solid over a polygon in the plane z = 0, of this height. `triangles` cover the polygon.
Mesh extruded(const std::vector<Vec2>& polygon, const std::vector<Triangle>& triangles, double height) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (const double z : {-0.5 * height, 0.5 * height})
    for (const Vec2& p : polygon) mesh.positions.push_back({p[0], p[1], z});
  for (const auto& [a, b, c] : triangles) {
    mesh.triangles.push_back({c, b, a});
    mesh.triangles.push_back({a + n, b + n, c + n});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, j + n});
    mesh.triangles.push_back({i, j + n, i + n});
  }
  return mesh;
}

Mesh prism(std::uint32_t sides, double height) {
  std::vector<Vec2> polygon;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::acos(-1) * i / sides;
    polygon.push_back({0.6 * std::cos(angle), 0.6 * std::sin(angle)});
    if (i >= 2) triangles.push_back({0, i - 1, i});
  }
  return extruded(polygon, triangles, height);
}

Mesh angle_bracket() {
  return extruded({{0, 0}, {1, 0}, {1, 0.4}, {0.4, 0.4}, {0.4, 1}, {0, 1}},
                  {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 0.6);
}

/// The convex hull of some points, of which no four lie in a plane.
Mesh hull(const std::vector<Vec3>& points) {
  Mesh mesh{points, {}, {}};
  const auto n = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b)
      for (std::uint32_t c = a + 1; c < n; ++c) {
        if (c == b) continue;
        const Vec3 normal = cross(points[b] - points[a], points[c] - points[a]);
        if (std::ranges::all_of(points, [&](const Vec3& p) { return dot(normal, p - points[a]) < 1e-12; }))
          mesh.triangles.push_back({a, b, c});
      }
  return mesh;
}

/// A cube of n × n squares a side.
Mesh fine_cube(std::uint32_t n) {
  Mesh mesh;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> numbers;
  const auto vertex = [&](const std::array<std::uint32_t, 3>& at) {
    const auto [place, added] = numbers.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (added)
      mesh.positions.push_back({double(at[0]) / n - 0.5, double(at[1]) / n - 0.5, double(at[2]) / n - 0.5});
    return place->second;
  };
  for (const std::uint32_t k : {0, 1, 2})
    for (const std::uint32_t side : {0u, n})
      for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
          const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
            std::array<std::uint32_t, 3> at;
            at[k] = side;
            at[(k + 1) % 3] = i + di;
            at[(k + 2) % 3] = j + dj;
            return vertex(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == n) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
  return mesh;
}

/// Two bodies in contact, in space.
struct Pose {
  std::array<Mesh, 2> bodies;
  double margin = 0;
  bool solids = true;
};

class Poses {
 public:
  explicit Poses(unsigned seed) : random_(seed) {}

  Pose pose() {
    Pose pose{.bodies = {shape(), shape()}};
    const double size = std::min(diagonal(bounds(pose.bodies[0])), diagonal(bounds(pose.bodies[1])));
    pose.margin = pick(3) == 0 ? 0.005 * size : 0;
    const double depth = size * std::pow(10, number(-4, -1.7));
    auto& [a, b] = pose.bodies;
    const int kind = pick(3);  // aligned, tilted, turned
    const auto quarter = [&] { return 0.5 * std::acos(-1) * pick(4); };
    Transform turn = rotation({1, 0, 0}, quarter()) * rotation({0, 0, 1}, quarter());
    if (kind == 1) turn = rotation(direction(), std::pow(10, number(-7, -1.2))) * turn;
    if (kind == 2) turn = rotation(direction(), number(0, 3));
    transform(b.positions, turn);
    place_beside(a, b, depth);
    if (kind != 0 || pick(8) == 0) approach(a, b, depth);
    return pose;
  }

 private:
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return normalized({normal(random_), normal(random_), normal(random_)});
  }
  static Transform rotation(const Vec3& axis, double angle) {
    const double s = std::sin(0.5 * angle);
    return Transform::quaternion({std::cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]});
  }

  Mesh shape() {
    switch (pick(12)) {
      case 0:
        return cube(0.5);
      case 1:
      case 2:
        return box({number(0.1, 1), number(0.1, 1), number(0.1, 1)});
      case 3:
        return box({1, 1, 0.5});
      case 4:
        return joined(moved(box({0.5, 1, 0.5}), {-0.6, 0, 0}), moved(box({0.5, 1, 0.5}), {0.6, 0, 0}));
      case 5: {
        std::vector<Vec3> points;
        for (int i = pick(8) + 4; i > 0; --i) points.push_back(direction());
        const Vec3 scale{number(0.2, 1), number(0.2, 1), number(0.2, 1)};
        for (Vec3& p : points)
          for (int k = 0; k < 3; ++k) p[k] *= scale[k];
        return hull(points);
      }
      case 6:
        return prism(static_cast<std::uint32_t>(3 + pick(4)), number(0.1, 2));
      case 7:
      case 8:
        return angle_bracket();
      case 9: {
        Mesh mesh = torus(12, 8);
        for (Vec3& p : mesh.positions) p = 0.3 * p;
        return mesh;
      }
      case 10:
        return fine_cube(static_cast<std::uint32_t>(2 + pick(3)));
      default: {
        Mesh mesh = sphere(pick(4) == 0 ? 2 : 1);
        const Vec3 scale{number(0.3, 0.8), number(0.3, 0.8), number(0.3, 0.8)};
        for (Vec3& p : mesh.positions)
          for (int k = 0; k < 3; ++k) p[k] *= scale[k];
        return mesh;
      }
    }
  }

  // Moves b so that its box is this deep in the box of a along an axis, and often flush with it along others.
  void place_beside(const Mesh& a, Mesh& b, double depth) {
    const Box of_a = bounds(a), of_b = bounds(b);
    const int axis = pick(3);
    Vec3 by;
    for (int k = 0; k < 3; ++k) {
      const double low = of_a.lower[k] - of_b.upper[k], high = of_a.upper[k] - of_b.lower[k];
      const double offset = pick(2) == 0 ? 0 : depth * number(-1, 1);
      if (k == axis)
        by[k] = pick(2) == 0 ? low + depth : high - depth;
      else if (const int where = pick(5); where < 2)
        by[k] = number(low, high);
      else if (where < 4)
        by[k] = (where == 2 ? of_a.lower[k] - of_b.lower[k] : of_a.upper[k] - of_b.upper[k]) + offset;
      else
        by[k] = 0.5 * (low + high) + offset;
    }
    b = moved(b, by);
  }

  // Moves b away from a, and back until its surface is this deep in that of a.
  void approach(const Mesh& a, Mesh& b, double depth) {
    const Box of_a = bounds(a), of_b = bounds(b);
    int axis = 0;
    double least = 1e9, by = 0;
    for (int k = 0; k < 3; ++k)
      for (const double d : {of_a.lower[k] - of_b.upper[k], of_a.upper[k] - of_b.lower[k]})
        if (std::abs(d) < least) {
          least = std::abs(d);
          by = d;
          axis = k;
        }
    Vec3 away{};
    away[axis] = (by < 0 ? -1 : 1) * (least + 0.1);
    b = moved(b, away);
    ProximityQuery query(a, b);
    const BoundedLength& separation = query.separation();
    if (!(separation.value > 0)) return;
    const auto& [on_a, on_b] = *separation.witness;
    b = moved(b, (1 + depth / separation.value) * (on_a - on_b));
  }

  std::mt19937 random_;
};

double solid_distance(const Mesh& solid, const Vec3& p) {
  const double distance = oracle::brute_force(solid, p);
  return oracle::winding_number(solid, p) != 0 ? -distance : distance;
}

/// Whether a function that is 1-Lipschitz is at least `value` somewhere on a triangle: by dividing it again
/// and again, where the values are largest or, to be `sure`, where it may be largest first.
template <class Function>
bool exceeds(const Function& f, const Corners& triangle, double value, bool sure) {
  struct Part {
    Corners at;
    Vec3 values;  // at the corners
    [[nodiscard]] double upper() const {
      double longest = 0;
      for (int k = 0; k < 3; ++k) longest = std::max(longest, norm(at[(k + 1) % 3] - at[k]));
      return std::ranges::min(values) + longest;
    }
  };
  const auto less = [sure](const Part& a, const Part& b) {
    return sure ? a.upper() < b.upper() : std::ranges::max(a.values) < std::ranges::max(b.values);
  };
  std::priority_queue<Part, std::vector<Part>, decltype(less)> open(less);
  open.push({triangle, {f(triangle[0]), f(triangle[1]), f(triangle[2])}});
  for (int divided = 0; !open.empty() && divided < (sure ? 200000 : 500); ++divided) {
    const Part part = open.top();
    open.pop();
    if (std::ranges::max(part.values) >= value) return true;
    if (part.upper() < value) continue;
    Part middle;
    for (int k = 0; k < 3; ++k) {
      middle.at[k] = 0.5 * (part.at[k] + part.at[(k + 1) % 3]);
      middle.values[k] = f(middle.at[k]);
    }
    for (int k = 0; k < 3; ++k)
      open.push({{part.at[k], middle.at[k], middle.at[(k + 2) % 3]},
                 {part.values[k], middle.values[k], middle.values[(k + 2) % 3]}});
    open.push(middle);
  }
  return false;
}

/// What is wrong with a contact, or nothing.
std::string fault(const Contact& c, const Pose& pose, double upper, double rounding) {
  const auto side = static_cast<std::size_t>(c.id >> 63);
  const std::array<Vec3, 2> points{c.point1, c.point2};
  const Vec3 &p = points[side], along = (side == 0 ? 1 : -1) * c.normal, vector = points[1 - side] - p;
  const Mesh& other = pose.bodies[1 - side];
  for (const std::size_t k : {0, 1}) {
    const Mesh& mesh = pose.bodies[k];
    if (c.on[k].face >= mesh.triangles.size()) return "face";
    const Triangle& t = mesh.triangles[c.on[k].face];
    Vec3 at{};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      if (!(c.on[k].barycentric[i] > -1e-6)) return "barycentric";
      sum += c.on[k].barycentric[i];
      at = at + c.on[k].barycentric[i] * mesh.positions[t[i]];
    }
    if (std::abs(sum - 1) > 1e-9 || norm(at - points[k]) > rounding) return "point off its face";
  }
  if (std::abs(norm(c.normal) - 1) > 1e-9) return "normal not of length 1";
  if (std::abs(c.depth) > rounding && norm(vector - c.depth * along) > rounding)
    return "normal not along the points";
  if (c.depth > upper) return "deeper than the bound";
  if (c.depth > rounding && solid_distance(other, p + (1e-3 * c.depth) * along) > rounding)
    return "not inside";
  if (-c.depth > pose.margin + rounding) return "beyond the margin";
  const double distance = solid_distance(other, p);
  if (std::abs(distance) > std::abs(c.depth) + rounding) return "closer than the surface";
  if (distance > pose.margin + rounding) return "not in contact";
  if (std::abs(distance) >= std::abs(c.depth) - rounding) return {};
  // Not the nearest way out of this point: one along the normal of a face.
  const Triangle& t = other.triangles[c.on[1 - side].face];
  const Vec3 normal = normalized(
      cross(other.positions[t[1]] - other.positions[t[0]], other.positions[t[2]] - other.positions[t[0]]));
  if (norm(normal - along) > 1e-6) return "neither nearest nor across a face";
  if (c.depth < rounding) return {};
  // It is the nearest one for a point of the surface beside it.
  const Mesh& own = pose.bodies[side];
  const Box box_of_other = bounds(other);
  const auto depth_at = [&](const Vec3& q) {
    const double below = dot(normal, other.positions[t[0]] - q);
    const double beyond = box_distance({q, q}, box_of_other);
    return std::min(below, beyond > 0 ? -beyond : -solid_distance(other, q));
  };
  // First close to the point.
  for (const auto& [reach, sure] :
       {std::pair(4.0, false), {30.0, false}, {1e9, false}, {4.0, true}, {30.0, true}, {1e9, true}})
    for (const Triangle& face : own.triangles) {
      Corners near{own.positions[face[0]], own.positions[face[1]], own.positions[face[2]]};
      if (oracle::distance(p, near[0], near[1], near[2]) > rounding) continue;
      double size = 0;
      for (const Vec3& corner : near) size = std::max(size, norm(corner - p));
      for (Vec3& corner : near)
        corner = p + std::min(1.0, reach * c.depth / (sure ? std::max(norm(corner - p), rounding) : size)) *
                         (corner - p);
      if (exceeds(depth_at, near, c.depth - rounding, sure)) return {};
    }
  return "not the way out of its surface";
}

/// Checks the contacts as above, and that those with a depth point upwards. Returns their number.
int expect_pushed_up(const Mesh& upper_body, const Mesh& lower_body, double depth) {
  const Pose pose{.bodies = {upper_body, lower_body}};
  ProximityQuery query(upper_body, lower_body);
  const double upper = query.penetration_depth()->upper;
  for (const Contact& c : query.contacts()) {
    EXPECT_EQ(fault(c, pose, upper, 1e-6), "") << c.id;
    EXPECT_NEAR(c.depth, depth, 1e-8) << c.id;
    EXPECT_NEAR(c.normal[2], 1, 1e-8) << c.id;
  }
  return static_cast<int>(query.contacts().size());
}

const Mesh kTable = moved(box({1, 1, 0.5}), {0, 0, -0.5});  // its top is at 0

// The side of the table is near to all points of the cube in it, and is no way out for any of them.
TEST(ContactDepth, OfACubeNearTheEdgeOfATableIsBelowItsTop) {
  for (const double depth : {0.0005, 0.01})
    for (const double x : {0.65, 0.7, 0.7495, 0.75, 0.7505, 0.85, 0.99})
      for (const double y : {0.1, 0.75, 0.85, 1.15}) {
        SCOPED_TRACE(testing::Message() << depth << " deep, at " << x << ' ' << y);
        EXPECT_GE(expect_pushed_up(moved(cube(0.25), {x, y, 0.25 - depth}), kTable, depth), 4);
      }
}

// Tilted by a little, the point of the cube at the side of the table is deeper below its top than any point
// is deep in it.
TEST(ContactDepth, OfATiltedCubeAcrossTheEdgeOfATableIsThatOfItsDeepestPoint) {
  for (const double tilt : {1e-9, 1e-6, 1e-4, 1e-2}) {
    SCOPED_TRACE(tilt);
    Mesh tilted = cube(0.25);
    transform(tilted.positions, Transform::quaternion({1, 0, 0.5 * tilt, 0}));
    const Box box = bounds(tilted);
    tilted = moved(tilted, {0.75 - box.lower[0], 0.1, -box.lower[2] - 0.005});
    const Pose pose{.bodies = {tilted, kTable}};
    ProximityQuery query(tilted, kTable);
    int carried = 0;
    for (const Contact& c : query.contacts()) {
      EXPECT_EQ(fault(c, pose, query.penetration_depth()->upper, 1e-6), "");
      carried += c.depth > 0.002 && c.normal[2] > 0.99 && c.point1[0] > 0.98;
    }
    EXPECT_GE(carried, 2);  // at the edge of the table
  }
}

// An open surface has no inside: nothing is deep in it, however far its face could push.
TEST(ContactDepth, OfASurfaceIsNeverPositive) {
  const Mesh sheet = square(2, 0);
  for (const double height : {-0.01, -0.0005, 0.0, 0.0005})
    for (const double x : {0.7, 0.75, 0.8}) {
      SCOPED_TRACE(testing::Message() << height << " at " << x);
      ProximityQuery query(moved(cube(0.25), {x, 0.75, 0.25 + height}), sheet, {.contact_margin = 0.02});
      ASSERT_FALSE(query.contacts().empty());
      for (const Contact& c : query.contacts())
        EXPECT_LE(c.depth, c.id >> 63 == 0 ? 1e-12 : query.penetration_depth()->upper);
    }
}

// A cube of mass 1 that falls without turning: the impulses of its contacts, as often as they change.
TEST(ContactDepth, OfACubeAcrossTwoTablesLeavesItAtRest) {
  for (const double gap : {0.0, 0.1, 0.15}) {
    SCOPED_TRACE(gap);
    const Mesh tables = joined(moved(kTable, {-1 - gap, 0, 0}), moved(kTable, {1 + gap, 0, 0}));
    ProximityQuery query(cube(0.25), tables);
    Vec3 centre{0, 0.1, 0.2495}, velocity{};
    constexpr double kTime = 1.0 / 120, kSlop = 1e-4;
    for (int frame = 0; frame < 240; ++frame) {
      velocity = velocity - Vec3{0, 0, 9.81 * kTime};
      query.set_pose(0, Transform::translation(centre));
      const std::span<const Contact> contacts = query.contacts();
      std::vector<double> impulses(contacts.size());
      for (int i = 0; i < 20; ++i)
        for (std::size_t c = 0; c < contacts.size(); ++c) {
          const double depth = contacts[c].depth;
          const double wanted = depth < 0 ? depth / kTime : 0.2 * std::max(0.0, depth - kSlop) / kTime;
          const double impulse = std::max(0.0, impulses[c] + wanted - dot(contacts[c].normal, velocity));
          velocity = velocity + (impulse - impulses[c]) * contacts[c].normal;
          impulses[c] = impulse;
        }
      EXPECT_LT(std::hypot(velocity[0], velocity[1]), 1e-6);
      centre = centre + kTime * velocity;
    }
    EXPECT_NEAR(centre[2], 0.25 - kSlop, 1e-4);
    EXPECT_NEAR(velocity[2], 0, 1e-4);
  }
}

TEST(ContactDepth, OfRandomPosesIsWithinTheBound) {
  const auto asked = [](const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : otherwise;
  };
  const int first = asked("SDM_FIRST_POSE", 0), count = asked("SDM_POSES", 1000);
  ASSERT_GT(count, 0);
  std::size_t inside = 0;
  for (int i = first; i < first + count; ++i) {
    SCOPED_TRACE("pose " + std::to_string(i));
    const Pose pose = Poses(static_cast<unsigned>(i)).pose();
    Mesh before = pose.bodies[1];
    if (i % 4 == 3)
      for (Vec3& p : before.positions) p = {1.3 * p[0] + 0.2 * p[1], 0.7 * p[1], p[2] - 0.4 * p[0]};
    ProximityQuery query(pose.bodies[0], before, {.contact_margin = pose.margin});
    if (i % 4 == 3) query.refit({}, pose.bodies[1].positions);
    const double upper = query.penetration_depth()->upper;
    Box both = bounds(pose.bodies[0]);
    extend(both, bounds(pose.bodies[1]));
    for (const Contact& c : query.contacts()) {
      inside += c.depth > 0;
      const std::string what = fault(c, pose, upper, 1e-6 * diagonal(both));
      ASSERT_EQ(what, "") << "contact " << c.id << ", depth " << c.depth << " of at most " << upper;
    }
  }
  EXPECT_GT(inside, static_cast<std::size_t>(count));
}

}  // namespace
}  // namespace sdm::test

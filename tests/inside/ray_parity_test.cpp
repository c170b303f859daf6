#include "mesh/crossings/ray_parity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

#include "geometry/vec.h"

namespace sdm {
namespace {

// The direction of the rays: the ray from the origin meets this point, to the bit.
constexpr Vec3 kOnRay{1, 0.0137035999, 0.0072973525};

struct Cone {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

/// A closed cone with its apex on the ray from the origin, about which its base runs at this x; vertices and
/// corners in random order.
Cone cone(double base, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const auto corners = static_cast<std::uint32_t>(3 + random() % 9);
  std::vector<double> angles(corners);
  for (std::uint32_t i = 0; i < corners; ++i)
    angles[i] = 2 * std::numbers::pi * (i + 0.4 * unit(random)) / corners;
  std::vector<std::uint32_t> names(corners + 2);  // the apex, the middle of the base, and its corners
  std::iota(names.begin(), names.end(), 0);
  std::ranges::shuffle(names, random);
  Cone cone;
  cone.positions.resize(names.size());
  cone.positions[names[0]] = kOnRay;
  const Vec3 middle = base * kOnRay;
  cone.positions[names[1]] = middle + Vec3{0.5 * (base - 1), 0.1, 0.05};
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double radius = 1 + unit(random);
    cone.positions[names[2 + i]] = middle + radius * Vec3{0, std::cos(angles[i]), std::sin(angles[i])};
    const std::uint32_t here = names[2 + i], next = names[2 + (i + 1) % corners];
    cone.triangles.push_back({names[0], here, next});
    cone.triangles.push_back({next, here, names[1]});
  }
  for (Triangle& t : cone.triangles)
    std::ranges::rotate(t, t.begin() + static_cast<std::ptrdiff_t>(random() % 3));
  return cone;
}

bool odd_from_origin(const Cone& cone) {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> faces;
  for (const auto& [a, b, c] : cone.triangles) {
    faces.push_back(static_cast<std::uint32_t>(faces.size()));
    Box& box = boxes.emplace_back();
    for (const std::uint32_t v : {a, b, c}) extend(box, cone.positions[v]);
  }
  const tree::AabbTree tree = tree::build_aabb_tree(boxes, faces, 4);
  bool odd = false;
  inside::for_each_crossing({cone.positions, cone.triangles, UnitFrame{}, tree}, {0, 0, 0},
                            [&](std::uint32_t) { odd = !odd; });
  return odd;
}

// The ray passes through a vertex exactly: from outside into the cone and out of its base, or from inside
// out.
TEST(RayParity, CountsAVertexOnceAtMost) {
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    EXPECT_FALSE(odd_from_origin(cone(2, random))) << "in and out " << i;
    EXPECT_TRUE(odd_from_origin(cone(-1, random))) << "out " << i;
  }
}

// A ray within a face and along its edges counts as one beside them.
TEST(RayParity, IgnoresFacesThatContainTheRay) {
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    Cone c = cone(3, random);
    // A corner of the base comes to lie on the ray: its edge to the apex does too.
    std::uint32_t corner = 0;
    while (c.positions[corner] == kOnRay || c.positions[corner][0] != 3) ++corner;
    c.positions[corner] = 4 * kOnRay;
    EXPECT_FALSE(odd_from_origin(c)) << i;
  }
}

}  // namespace
}  // namespace sdm

// The embedded letters are the solids that scenes/letters.h and scenes/meshes/README.md describe.
#include "scenes/letters.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/vec.h"

namespace sdm::scenes {
namespace {

struct Letter {
  const char* name;
  Mesh (*mesh)();
  std::uint32_t vertices, triangles;
  double spacing;
};
void PrintTo(const Letter& letter, std::ostream* out) {
  *out << letter.name;
}

struct Letters : ::testing::TestWithParam<Letter> {};

TEST_P(Letters, AreClosedConnectedAndOfGenusZero) {
  const MeshInfo info = inspect(GetParam().mesh());
  EXPECT_TRUE(info.closed && info.oriented && info.manifold);
  EXPECT_EQ(info.components, 1u);
  EXPECT_EQ(info.degenerate_faces + info.duplicate_faces + info.unused_vertices, 0u);
  EXPECT_EQ(info.vertices + info.triangles, info.edges + 2);
  EXPECT_EQ(info.vertices, GetParam().vertices);
  EXPECT_EQ(info.triangles, GetParam().triangles);
}

TEST_P(Letters, HaveUnitHeightAndTheirDepthAndAreCentred) {
  const Box box = bounds(GetParam().mesh());
  EXPECT_NEAR(box.upper[1] - box.lower[1], 1, 1e-3);
  EXPECT_DOUBLE_EQ(box.upper[2], 0.15);
  EXPECT_LE(norm(centre(box)), 1e-3);
  for (int k = 0; k < 3; ++k) EXPECT_LT(box.upper[k] - box.lower[k], 1 + 1e-9);
}

// Front and back are flat and congruent, and the sides are vertical: the volume is the area of the front
// times the depth, with a positive sign as the faces point outward.
TEST_P(Letters, AreOutwardOrientedExtrusions) {
  const Mesh mesh = GetParam().mesh();
  double volume = 0, front = 0, back = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    volume += dot(p, cross(q, r)) / 6;
    const Vec3 normal = cross(q - p, r - p);
    if (p[2] == q[2] && q[2] == r[2])
      (normal[2] > 0 ? front : back) += 0.5 * normal[2];
    else
      EXPECT_NEAR(normal[2], 0, 1e-15);
  }
  EXPECT_NEAR(front, -back, 1e-12);
  EXPECT_NEAR(volume, front * 0.3, 1e-12);
}

TEST_P(Letters, AreEvenlyMeshed) {
  const Mesh mesh = GetParam().mesh();
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const double edge = norm(mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]]);
      EXPECT_GT(edge, 0.5 * GetParam().spacing);
      EXPECT_LT(edge, 2 * GetParam().spacing);
    }
}

// Seen from +z: the arms of an E end at the right, where the G, whose opening is there too, has its bar. At
// the height of the bar, the middle of the letter is empty in both.
TEST(Letters, AreReadableFromTheFront) {
  const auto fills = [](const Mesh& mesh, double x, double y) {
    return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
      const auto side = [&](int k) {
        const Vec3 &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
        return cross(Vec2{b[0] - a[0], b[1] - a[1]}, Vec2{x - a[0], y - a[1]});
      };
      return side(0) > 0 && side(1) > 0 && side(2) > 0;
    });
  };
  const Mesh e = letter_e(), g = letter_g();
  for (const Mesh* mesh : {&e, &g}) {
    EXPECT_TRUE(fills(*mesh, bounds(*mesh).lower[0] + 0.1, 0));     // the back
    EXPECT_FALSE(fills(*mesh, bounds(*mesh).upper[0] - 0.1, 0.2));  // the opening
  }
  for (const double y : {-0.45, 0.05, 0.45}) EXPECT_TRUE(fills(e, 0.2, y)) << y;  // the arms
  EXPECT_TRUE(fills(g, bounds(g).upper[0] - 0.1, -0.2));                          // the bar
}

INSTANTIATE_TEST_SUITE_P(Scenes, Letters,
                         ::testing::Values(Letter{"E", letter_e, 1051, 2098, 0.0492},
                                           Letter{"G", letter_g, 802, 1600, 0.0570}),
                         [](const auto& letter) { return std::string(letter.param.name); });

}  // namespace
}  // namespace sdm::scenes

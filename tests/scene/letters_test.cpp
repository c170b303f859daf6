// The letters of the scenes and benchmarks are the solids they are said to be.
#include "scene/letters.h"

#include <gtest/gtest.h>
#include <sdm/error.h>

#include <cmath>
#include <string>

#include "core/vec.h"
#include "scene/letter_outline.h"

namespace sdm {
namespace {

double area(const std::vector<Contour>& contours) {
  double twice = 0;
  for (const Contour& contour : contours)
    for (std::size_t i = 0; i < contour.size(); ++i)
      twice += cross(contour[i], contour[(i + 1) % contour.size()]);
  return 0.5 * twice;
}

TEST(Letters, AreClosedSolidsAsDeepAsTheyShouldBe) {
  for (const char character : std::string("EGOBSDM8"))
    for (const double spacing : {0.03, 0.05, 0.08}) {
      SCOPED_TRACE(std::string(1, character) + " at " + std::to_string(spacing));
      const MeshInfo info = inspect(letter(character, spacing));
      EXPECT_TRUE(info.closed && info.oriented && info.manifold);
      EXPECT_EQ(info.components, 1u);
      EXPECT_EQ(info.degenerate_faces + info.duplicate_faces + info.unused_vertices, 0u);
      EXPECT_NEAR(info.volume, area(letter_outline(character, spacing)) * kLetterDepth, 1e-9);
    }
}

TEST(Letters, HaveTheHolesOfTheirShape) {
  for (const auto& [character, holes] : {std::pair{'E', 0}, {'G', 0}, {'O', 1}, {'B', 2}}) {
    const MeshInfo info = inspect(letter(character, 0.05));
    const auto euler = static_cast<int>(info.vertices + info.triangles) - static_cast<int>(info.edges);
    EXPECT_EQ(euler, 2 - 2 * holes) << character;
  }
}

TEST(Letters, PointOutwardAndAreOneHigh) {
  const Mesh mesh = letter('E', 0.05);
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 6;
  EXPECT_NEAR(volume, inspect(mesh).volume, 1e-9);
  const Box box = bounds(mesh);
  EXPECT_NEAR(box.hi[1] - box.lo[1], 1, 1e-9);
  EXPECT_NEAR(box.hi[2] - box.lo[2], kLetterDepth, 1e-9);
}

TEST(Letters, AreEvenlyMeshed) {
  const double spacing = 0.05;
  const Mesh mesh = letter('G', spacing);
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const double edge = norm(mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]]);
      EXPECT_GT(edge, 0.5 * spacing);
      EXPECT_LT(edge, 2 * spacing);
    }
}

TEST(Letters, ReachTheirNumberOfTriangles) {
  for (const auto& [character, asked] : {std::pair{'E', 2100}, {'G', 1600}, {'O', 1000}, {'E', 10000}})
    EXPECT_NEAR(static_cast<double>(letter_of(character, asked).triangles.size()), asked, 0.03 * asked)
        << character;
}

TEST(Letters, RefuseWhatHasNoShape) {
  EXPECT_THROW((void)letter(' ', 0.05), Error);
}

}  // namespace
}  // namespace sdm

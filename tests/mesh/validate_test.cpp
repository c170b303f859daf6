#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/mesh.h>

#include <limits>
#include <vector>

#include "mesh/validate.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void expect_refused(const Mesh& mesh, const char* fault) {
  EXPECT_THAT([&] { validate(mesh); }, ThrowsMessage<Error>(HasSubstr(fault)));
}

TEST(Validate, AcceptsValidMeshes) {
  EXPECT_NO_THROW(validate(test::tetrahedron()));
  EXPECT_NO_THROW(validate(test::torus(8, 5)));
}

TEST(Validate, ToleratesSingleDegenerateAndDuplicateFaces) {
  Mesh mesh = test::tetrahedron();
  mesh.triangles.insert(mesh.triangles.end(), {{0, 0, 1}, {2, 2, 2}, {0, 2, 1}});
  EXPECT_NO_THROW(validate(mesh));
}

TEST(Validate, RejectsMeshesWithoutTriangles) {
  expect_refused({}, "no triangles");
  expect_refused({{{0, 0, 0}}, {}, {}}, "no triangles");
}

TEST(Validate, RejectsIndicesOutOfRange) {
  Mesh mesh = test::tetrahedron();
  mesh.triangles[2][1] = 4;
  expect_refused(mesh, "index out of range: triangle 2 refers to vertex 4 of 4");
}

TEST(Validate, RejectsNonFiniteAndTooLargeCoordinates) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mesh mesh = test::tetrahedron();
    mesh.positions[3][1] = bad;
    expect_refused(mesh, "vertex 3 has a NaN or infinite coordinate");
  }
  Mesh mesh = test::tetrahedron();
  mesh.positions[1][0] = -1e38;
  expect_refused(mesh, "too large");
  mesh.positions[1][0] = -1e37;
  EXPECT_NO_THROW(validate(mesh));
}

TEST(Validate, RejectsMeshesWithoutArea) {
  const std::vector<Vec3> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  expect_refused({line, {{0, 1, 2}, {0, 0, 1}, {2, 2, 2}}, {}}, "all triangles are degenerate");
}

TEST(Validate, RejectsTextureCoordinatesOfSomeTrianglesOnly) {
  Mesh mesh = test::torus(4, 4);
  mesh.corner_uvs.pop_back();
  expect_refused(mesh, "texture coordinates for 31 of 32 triangles");
  mesh = test::torus(4, 4);
  mesh.corner_uvs[7][2][1] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(mesh, "triangle 7 has a NaN or infinite texture coordinate");
}

TEST(Bounds, EncloseExactlyTheUsedVertices) {
  Mesh mesh = test::tetrahedron();
  mesh.positions.push_back({100, 100, 100});
  EXPECT_EQ(bounds(mesh).lower, (Vec3{0, 0, 0}));
  EXPECT_EQ(bounds(mesh).upper, (Vec3{1, 1, 1}));
  EXPECT_GT(bounds({}).lower[0], bounds({}).upper[0]);
}

TEST(Bounds, AreFoundByValidationToo) {
  Mesh mesh = test::torus(9, 7);
  mesh.corner_uvs.clear();
  mesh.positions.insert(mesh.positions.end(), {{100, 100, 100}, {-100, -100, -100}, {3, -4, 5}});
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.triangles.insert(mesh.triangles.end(), {{last - 1, last - 1, last - 1}, {0, 0, last}});
  const Box box = mesh::validated_bounds(mesh);
  EXPECT_EQ(box.lower, bounds(mesh).lower);
  EXPECT_EQ(box.upper, bounds(mesh).upper);
  EXPECT_EQ(box.upper[2], 5);
  EXPECT_LT(box.upper[0], 100);
}

}  // namespace
}  // namespace sdm

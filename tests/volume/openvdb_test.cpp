// OpenVDB reads the files of fields, and its own level sets agree with them.
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "support/temporary_folder.h"
#include "volume/scenes.h"

namespace sdm::test {
namespace {

struct OpenVdb : ::testing::Test {
  TemporaryFolder folder;

  static void SetUpTestSuite() { openvdb::initialize(); }

  openvdb::FloatGrid::Ptr read_back(const DistanceField& field) {
    write_field(folder / "field.vdb", field);
    openvdb::io::File file((folder / "field.vdb").string());
    file.open(false);
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("distance"));
    file.close();
    return grid;
  }
};

openvdb::Coord coord(const Grid& grid, std::size_t i) {
  const auto x = static_cast<int>(i % grid.dims[0]), y = static_cast<int>(i / grid.dims[0] % grid.dims[1]),
             z = static_cast<int>(i / grid.dims[0] / grid.dims[1]);
  return {x, y, z};
}

void expect_values(const openvdb::FloatGrid& vdb, const DistanceField& field) {
  auto accessor = vdb.getConstAccessor();
  std::size_t active = 0, wrong = 0;
  for (std::size_t i = 0; i < field.distance.size(); ++i) {
    float value = 0;
    const bool on = accessor.probeValue(coord(field.grid, i), value);
    active += on;
    wrong += on == std::isnan(field.distance[i]) || (on && value != field.distance[i]);
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(vdb.activeVoxelCount(), active) << "none outside of the grid";
}

TEST_F(OpenVdb, ReadsFields) {
  for (const FieldScene& scene : field_scenes())
    for (const double part : {0.05, std::numeric_limits<double>::infinity()}) {
      SCOPED_TRACE(scene.name + ", band " + std::to_string(part));
      const DistanceField field =
          compute_field(Sites(scene.mesh), scene.grid, {.max_distance = part * diagonal_of(scene)});
      const openvdb::FloatGrid::Ptr vdb = read_back(field);
      ASSERT_TRUE(vdb);
      expect_values(*vdb, field);
      for (const Vec3& index : {Vec3{0, 0, 0}, Vec3{1, 2, 3}}) {
        const openvdb::Vec3d p = vdb->indexToWorld(openvdb::Vec3d(index[0], index[1], index[2]));
        for (int k = 0; k < 3; ++k)
          EXPECT_DOUBLE_EQ(p[k], scene.grid.origin[k] + index[k] * scene.grid.spacing[k]);
      }
      const bool one_size =
          scene.grid.spacing[0] == scene.grid.spacing[1] && scene.grid.spacing[0] == scene.grid.spacing[2];
      EXPECT_EQ(vdb->hasUniformVoxels(), one_size);
    }
}

// Larger than the nodes of all levels of OpenVDB's trees.
TEST_F(OpenVdb, ReadsLongFields) {
  const Mesh mesh = joined(moved(sphere(1), {2, 0, 0}), moved(sphere(1), {4498, 0, 0}));
  const DistanceField field = compute_field(
      Sites(mesh), make_grid({{0, -1.5, -1.5}, {4500, 1.5, 1.5}}, {9001, 7, 7}), {.max_distance = 1});
  EXPECT_GT(field.beyond_max_distance, 0u);
  expect_values(*read_back(field), field);
}

TEST_F(OpenVdb, FindsLevelSetsComplete) {
  const Mesh mesh = joined(moved(ring(20), {0.9, 0.2, 0.1}), sphere(3));
  const Grid grid = make_grid(around(mesh, 0.1), 0.05);
  const DistanceField field = compute_field(Sites(mesh), grid, {.max_distance = 0.15});
  const openvdb::FloatGrid::Ptr vdb = read_back(field);
  EXPECT_EQ(vdb->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(vdb->background(), 0.15f);
  const openvdb::FloatGrid::Ptr filled = vdb->deepCopy();
  openvdb::tools::signedFloodFill(filled->tree());
  std::size_t inside = 0, wrong = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const float d = vdb->tree().getValue(coord(grid, i));
    inside += d == -0.15f;
    wrong += d != filled->tree().getValue(coord(grid, i));
  }
  EXPECT_EQ(wrong, 0u) << "signs beyond the maximum distance are those that OpenVDB finds";
  EXPECT_GT(inside, 0u);

  const DistanceField without =
      compute_field(Sites(mesh), grid, {.sign = SignMethod::none, .max_distance = 0.15});
  EXPECT_EQ(read_back(without)->getGridClass(), openvdb::GRID_UNKNOWN);
}

// A mesh as OpenVDB reads it: in the coordinates of the grid's indices.
struct IndexSpaceMesh {
  const Mesh& mesh;
  const Grid& grid;

  [[nodiscard]] std::size_t polygonCount() const { return mesh.triangles.size(); }
  [[nodiscard]] std::size_t pointCount() const { return mesh.positions.size(); }
  [[nodiscard]] std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& p) const {
    const Vec3& v = mesh.positions[mesh.triangles[face][corner]];
    for (int k = 0; k < 3; ++k) p[k] = (v[k] - grid.origin[k]) / grid.spacing[k];
  }
};

// OpenVDB's distances are those to some face near a point, which is not always the closest one: none is
// smaller than ours, and few are larger. It decides signs by filling what is enclosed, so that the meshes
// must not intersect themselves, and takes some points inside, within half a cell of the surface, for
// outside.
TEST_F(OpenVdb, AgreesWithFields) {
  for (const Mesh& mesh : {sphere(3), torus(24, 12), load("cow.off"), placed(cube(), "rotate:10:20:30")}) {
    const double spacing = diagonal(bounds(mesh)) / 60;
    constexpr float kCells = 3;  // of the band
    Box box = bounds(mesh);
    for (int k = 0; k < 3; ++k) {
      box.lower[k] -= 4.3 * spacing;
      box.upper[k] += 4.1 * spacing;
    }
    const Grid grid = make_grid(box, spacing);
    const DistanceField field = compute_field(Sites(mesh), grid, {.max_distance = kCells * spacing});
    using namespace openvdb::tools;
    const auto vdb = meshToVolume<openvdb::FloatGrid>(
        IndexSpaceMesh{mesh, grid}, *openvdb::math::Transform::createLinearTransform(spacing), kCells, kCells,
        DISABLE_RENORMALIZATION | DISABLE_INTERSECTING_VOXEL_REMOVAL);

    const double tolerance = 1e-4 * spacing;
    std::size_t both = 0, larger = 0, smaller = 0, wrong_signs = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      float theirs = 0;
      if (!vdb->tree().probeValue(coord(grid, i), theirs) || std::isnan(field.distance[i])) continue;
      const double ours = field.distance[i];
      ++both;
      smaller += std::abs(theirs) < std::abs(ours) - tolerance;
      larger += std::abs(theirs) > std::abs(ours) + tolerance;
      wrong_signs += std::abs(ours) > spacing && (theirs < 0) != (ours < 0);
    }
    EXPECT_GT(both, 0.999 * static_cast<double>(vdb->activeVoxelCount()));
    EXPECT_EQ(smaller, 0u);
    EXPECT_LT(larger, 0.05 * static_cast<double>(both));
    EXPECT_EQ(wrong_signs, 0u);
  }
}

}  // namespace
}  // namespace sdm::test

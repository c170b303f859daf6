// What a glTF file adds to its triangles: instances, morph targets, skins and extensions.
#include <gmock/gmock.h>
#include <sdm/mesh_files.h>

#include <numbers>
#include <vector>

#include "io_read/gltf_store.h"
#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::HasSubstr;

// From the origin to (1, 1, 1).
Mesh unit_cube() {
  Mesh mesh = cube(0.5);
  for (Vec3& p : mesh.positions) p = p + Vec3{0.5, 0.5, 0.5};
  return mesh;
}

double volume(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(cross(mesh.positions[a], mesh.positions[b]), mesh.positions[c]);
  return six / 6;
}

void expect_box(const Mesh& mesh, const Vec3& lo, const Vec3& hi, double tolerance = 0) {
  const Box box = bounds(mesh);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(box.lower[k], lo[k], tolerance);
    EXPECT_NEAR(box.upper[k], hi[k], tolerance);
  }
}

/// A document with one mesh, the unit cube.
struct CubeModel {
  GltfStore store;
  std::string attributes = R"("POSITION":)" + store.vec3(unit_cube().positions);
  std::string indices = store.corners(unit_cube());
  std::string targets{}, of_mesh{}, more{};  ///< further members, which begin with a comma

  [[nodiscard]] std::string members(const std::string& nodes) const {
    return R"("nodes":[)" + nodes + R"(],"meshes":[{"primitives":[{"attributes":{)" + attributes +
           R"(},"indices":)" + indices + targets + "}]" + of_mesh + "}]" + more;
  }
  [[nodiscard]] Mesh read(const std::string& nodes) const {
    return read_as("a.glb", store.glb(members(nodes)));
  }
  [[nodiscard]] std::string fault(const std::string& nodes) const {
    return fault_of("a.glb", store.glb(members(nodes)));
  }
};

std::string instancing(const std::string& attributes, const std::string& node = "") {
  return R"({"mesh":0,)" + node + R"("extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)" + attributes +
         "}}}}";
}

TEST(GltfInstances, AreCopies) {
  CubeModel model;
  const std::string translations = model.store.vec3({{0, 0, 0}, {5, 0, 0}, {10, 0, 0}});
  model.more =
      R"(,"extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"])";
  const Mesh mesh = model.read(instancing(R"("TRANSLATION":)" + translations));
  EXPECT_EQ(mesh.triangles.size(), 36u);
  EXPECT_EQ(mesh.positions.size(), 24u);
  EXPECT_NEAR(volume(mesh), 3, 1e-14);
  expect_box(mesh, {0, 0, 0}, {11, 1, 1});
}

// Scaled, turned by 90° about z, moved, and then placed by the node: in this order.
TEST(GltfInstances, AreScaledTurnedAndMovedWithinTheNode) {
  const std::vector<double> unit{0, 0, std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2};
  for (const int code : {5126, 5122, 5120}) {
    CubeModel model;
    std::vector<double> turn = unit;
    for (double& x : turn) x *= code == 5122 ? 32767 : code == 5120 ? 127 : 1;
    const std::string members = code == 5126 ? "" : R"(,"normalized":true)";
    const std::string rotation = code == 5126 ? model.store.rows<float>("VEC4", 1, turn)
                                 : code == 5122
                                     ? model.store.rows<std::int16_t>("VEC4", 1, turn, code, members)
                                     : model.store.rows<std::int8_t>("VEC4", 1, turn, code, members);
    const std::string attributes = R"("TRANSLATION":)" + model.store.vec3({{1, 0, 0}}) + R"(,"ROTATION":)" +
                                   rotation + R"(,"SCALE":)" + model.store.vec3({{2, 3, 4}});
    expect_box(model.read(instancing(attributes, R"("translation":[0,0,10],"scale":[1,1,0.5],)")),
               {-2, 0, 10}, {1, 2, 12}, 1e-6);
  }
}

TEST(GltfInstances, FaultsAreNamed) {
  CubeModel model;
  const std::string three = model.store.vec3({{0, 0, 0}, {5, 0, 0}, {10, 0, 0}}),
                    two = model.store.vec3({{1, 1, 1}, {2, 2, 2}}),
                    zeros = model.store.rows<float>("VEC4", 2, std::vector<double>(8, 0.0));
  EXPECT_THAT(model.fault(instancing(R"("TRANSLATION":)" + three + R"(,"SCALE":)" + two)),
              HasSubstr("differ in their number of instances"));
  EXPECT_THAT(model.fault(instancing(R"("ROTATION":)" + two)),
              HasSubstr("ROTATION of EXT_mesh_gpu_instancing"));
  EXPECT_THAT(model.fault(instancing(R"("ROTATION":)" + zeros)), HasSubstr("quaternion of length 0"));
  EXPECT_THAT(model.fault(instancing(R"("_ID":)" + three)), HasSubstr("no TRANSLATION"));
  EXPECT_THAT(model.fault(instancing(R"("TRANSLATION":)" + three, R"("skin":0,)")),
              HasSubstr("both a skin and EXT_mesh_gpu_instancing"));
}

/// One target that moves the upper side by 2.
CubeModel growing_cube() {
  CubeModel model;
  std::vector<Vec3> up;
  for (const Vec3& p : unit_cube().positions) up.push_back({0, 0, 2 * p[2]});
  model.targets = R"(,"targets":[{"POSITION":)" + model.store.sparse_vec3(up) + "}]";
  return model;
}

TEST(GltfMorph, DefaultWeightsApply) {
  CubeModel model = growing_cube();
  EXPECT_NEAR(volume(model.read(R"({"mesh":0})")), 1, 1e-14);
  model.of_mesh = R"(,"weights":[0.5])";
  EXPECT_NEAR(volume(model.read(R"({"mesh":0})")), 2, 1e-14);
  // Those of the node instead, for this node.
  expect_box(model.read(R"({"mesh":0,"weights":[1.5]},{"mesh":0,"translation":[4,0,0]})"), {0, 0, 0},
             {5, 1, 4});
  EXPECT_NEAR(volume(model.read(R"({"mesh":0,"weights":[1.5]},{"mesh":0,"translation":[4,0,0]})")), 4 + 2,
              1e-14);
}

TEST(GltfMorph, PrimitivesWithoutTargetsStay) {
  CubeModel model = growing_cube();
  const std::string still = R"(},{"attributes":{)" + model.attributes + R"(},"indices":)" + model.indices;
  model.targets += still;
  EXPECT_NEAR(volume(model.read(R"({"mesh":0,"weights":[1]})")), 3 + 1, 1e-14);
  model.targets = still;
  EXPECT_NEAR(volume(model.read(R"({"mesh":0,"weights":[1,2]})")), 1 + 1, 1e-14);
}

TEST(GltfMorph, FaultsAreNamed) {
  CubeModel model = growing_cube();
  EXPECT_THAT(model.fault(R"({"mesh":0,"weights":[1,2]})"), HasSubstr("2 weights for 1 morph targets"));
  model.targets = R"(,"targets":[{"POSITION":)" + model.store.vec3({{1, 0, 0}}) + "}]";
  EXPECT_THAT(model.fault(R"({"mesh":0,"weights":[1]})"), HasSubstr("differ in their number of vertices"));
}

// An animated node takes its weights from the animation; the others keep theirs.
TEST(GltfMorph, AnimationsReplaceDefaultWeights) {
  CubeModel model = growing_cube();
  model.of_mesh = R"(,"weights":[0.5])";
  model.more =
      R"(,"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":)" +
      model.store.scalars({0, 1}) + R"(,"output":)" + model.store.scalars({0, 1}) + "}]}]";
  const std::string nodes = R"({"mesh":0},{"mesh":0,"translation":[4,0,0]})";
  MeshSequence sequence(write_file("a.glb", model.store.glb(model.members(nodes))).string());
  ASSERT_EQ(sequence.frame_count(), 2u);
  Mesh mesh = sequence.mesh();
  EXPECT_NEAR(volume(mesh), 1 + 2, 1e-14);
  mesh.positions.assign(sequence.positions(1).begin(), sequence.positions(1).end());
  EXPECT_NEAR(volume(mesh), 3 + 2, 1e-14);
}

/// A skin whose joints are the given nodes; `bind` moves to the first from rest.
struct SkinnedCube : CubeModel {
  std::string joints, weights;  ///< their accessors

  explicit SkinnedCube(const std::string& joint_nodes = "[1]", const std::vector<int>& joint_of_vertex = {},
                       const std::string& bind = "") {
    const std::size_t n = unit_cube().positions.size();
    std::vector<int> all_joints(4 * n, 0);
    std::vector<double> all_weights(4 * n, 0.0);
    for (std::size_t v = 0; v < n; ++v) {
      all_weights[4 * v] = 1;
      if (!joint_of_vertex.empty()) all_joints[4 * v] = joint_of_vertex[v];
    }
    set_influences(all_joints, all_weights);
    more = R"(,"skins":[{"joints":)" + joint_nodes + bind + "}]";
  }
  void set_influences(const std::vector<int>& of_joints, const std::vector<double>& of_weights) {
    const std::size_t n = unit_cube().positions.size();
    joints = store.rows<std::uint8_t>("VEC4", n, of_joints, 5121);
    weights = store.rows<float>("VEC4", n, of_weights);
    attributes = R"("POSITION":0,"JOINTS_0":)" + joints + R"(,"WEIGHTS_0":)" + weights;
  }
};

// glTF 2.0, 3.7.3: the transform of the node with the mesh does not apply.
TEST(GltfSkin, JointsReplaceTheNode) {
  SkinnedCube model;
  const Mesh mesh = model.read(R"({"mesh":0,"skin":0,"scale":[100,100,100]},{"translation":[7,0,0]})");
  expect_box(mesh, {7, 0, 0}, {8, 1, 1});
  EXPECT_NEAR(volume(mesh), 1, 1e-14);
  // Without the skin, it does.
  expect_box(model.read(R"({"mesh":0,"scale":[100,100,100]},{"translation":[7,0,0]})"), {0, 0, 0},
             {100, 100, 100});
}

TEST(GltfSkin, InverseBindMatricesAndParentsOfJointsApply) {
  SkinnedCube model("[2]");
  // Rest to joint: half the size, and moved by −3 in y.
  const std::string bind = model.store.rows<float>(
      "MAT4", 1, std::vector<double>{0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, -3, 0, 1});
  model.more = R"(,"skins":[{"joints":[2],"inverseBindMatrices":)" + bind + "}]";
  expect_box(model.read(R"({"mesh":0,"skin":0},{"children":[2],"scale":[2,2,2]},{"translation":[1,3,0]})"),
             {2, 0, 0}, {3, 1, 1});
}

// The lower side stays and the upper side follows another joint; between them, weights average.
TEST(GltfSkin, VerticesFollowSeveralJoints) {
  const std::vector<Vec3> rest = unit_cube().positions;
  const std::string nodes = R"({"mesh":0,"skin":0},{},{"translation":[0,0,4]})";
  for (const double up : {0.0, 0.25, 1.0}) {
    SkinnedCube model("[1,2]");
    std::vector<int> joints;
    std::vector<double> weights;
    for (const Vec3& p : rest) {
      joints.insert(joints.end(), {0, 1, 0, 0});
      weights.insert(weights.end(), {1 - up * p[2], up * p[2], 0, 0});
    }
    model.set_influences(joints, weights);
    EXPECT_NEAR(volume(model.read(nodes)), 1 + 4 * up, 1e-6);
    // A second set of the same influences: their weights sum to 2, and nothing changes.
    model.attributes += R"(,"JOINTS_1":)" + model.joints + R"(,"WEIGHTS_1":)" + model.weights;
    EXPECT_NEAR(volume(model.read(nodes)), 1 + 4 * up, 1e-6);
  }
}

TEST(GltfSkin, NormalizedWeights) {
  SkinnedCube model("[1,2]");
  const std::size_t n = unit_cube().positions.size();
  std::vector<int> weights;
  for (std::size_t v = 0; v < n; ++v) weights.insert(weights.end(), {0, 255, 0, 0});
  std::vector<int> joints(4 * n, 1);
  model.attributes = R"("POSITION":0,"JOINTS_0":)" +
                     model.store.rows<std::uint16_t>("VEC4", n, joints, 5123) + R"(,"WEIGHTS_0":)" +
                     model.store.rows<std::uint8_t>("VEC4", n, weights, 5121, R"(,"normalized":true)");
  expect_box(model.read(R"({"mesh":0,"skin":0},{},{"translation":[0,0,4]})"), {0, 0, 4}, {1, 1, 5});
}

TEST(GltfSkin, MirroredJointsKeepTheOutside) {
  EXPECT_NEAR(volume(SkinnedCube().read(R"({"mesh":0,"skin":0},{"scale":[-2,1,1]})")), 2, 1e-14);
}

TEST(GltfSkin, MorphTargetsApplyBeforeIt) {
  SkinnedCube model;
  std::vector<Vec3> up;
  for (const Vec3& p : unit_cube().positions) up.push_back({0, 0, 2 * p[2]});
  model.targets = R"(,"targets":[{"POSITION":)" + model.store.vec3(up) + "}]";
  const std::string nodes = R"({"mesh":0,"skin":0,"weights":[0.5]},{"translation":[7,0,0],"scale":[1,1,10]})";
  expect_box(model.read(nodes), {7, 0, 0}, {8, 1, 20});
  model.more +=
      R"(,"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":)" +
      model.store.scalars({0, 1}) + R"(,"output":)" + model.store.scalars({0, 1}) + "}]}]";
  MeshSequence sequence(write_file("a.glb", model.store.glb(model.members(nodes))).string());
  Mesh mesh = sequence.mesh();
  expect_box(mesh, {7, 0, 0}, {8, 1, 10});
  mesh.positions.assign(sequence.positions(1).begin(), sequence.positions(1).end());
  expect_box(mesh, {7, 0, 0}, {8, 1, 30});
}

TEST(GltfSkin, FaultsAreNamed) {
  const std::string nodes = R"({"mesh":0,"skin":0},{"translation":[7,0,0]})";
  const std::size_t n = unit_cube().positions.size();
  EXPECT_THAT(SkinnedCube("[9]").fault(nodes), HasSubstr("joint at node 9"));
  EXPECT_THAT(SkinnedCube("[]").fault(nodes), HasSubstr("skin 0 has no joints"));
  EXPECT_THAT(SkinnedCube("[1]", std::vector<int>(n, 1)).fault(nodes), HasSubstr("follows joint 1 of 1"));
  EXPECT_THAT(SkinnedCube("[1]", {}, R"(,"inverseBindMatrices":0)").fault(nodes),
              HasSubstr("one MAT4 for each of its 1 joints"));
  EXPECT_THAT(SkinnedCube().fault(R"({"mesh":0,"skin":3},{})"), HasSubstr("item 3 of skins"));
  SkinnedCube model;
  model.set_influences(std::vector<int>(4 * n, 0), std::vector<double>(4 * n, 0.0));
  EXPECT_THAT(model.fault(nodes), HasSubstr("vertex 0 of a skin follows no joint"));
  model.set_influences(std::vector<int>(4 * n, 0), std::vector<double>(4 * n, -1.0));
  EXPECT_THAT(model.fault(nodes), HasSubstr("has the weight -1"));
  model.attributes = R"("POSITION":0)";
  EXPECT_THAT(model.fault(nodes), HasSubstr("no attribute JOINTS_0"));
  // A joint in a circle of nodes has no place.
  EXPECT_THAT(SkinnedCube().fault(R"({"mesh":0,"skin":0},{"children":[2]},{"children":[1]})"),
              HasSubstr("node"));
  SkinnedCube projective;
  const std::string bind = projective.store.rows<float>("MAT4", 1, std::vector<double>(16, 1.0));
  projective.more = R"(,"skins":[{"joints":[1],"inverseBindMatrices":)" + bind + "}]";
  EXPECT_THAT(projective.fault(nodes), HasSubstr("not affine"));
}

TEST(GltfExtensions, OnlySupportedOnesMayBeRequired) {
  const auto fault_with = [](const std::string& extension) {
    CubeModel model;
    model.more =
        R"(,"extensionsUsed":[")" + extension + R"("],"extensionsRequired":[")" + extension + R"("])";
    return model.fault(R"({"mesh":0})");
  };
  for (const char* supported : {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_texture_transform",
                                "KHR_materials_unlit", "KHR_texture_basisu"})
    EXPECT_EQ(fault_with(supported), "");
  EXPECT_THAT(fault_with("VENDOR_secret"),
              HasSubstr("requires the extension VENDOR_secret, which is not supported"));
  EXPECT_THAT(fault_with("KHR_node_visibility"), HasSubstr("requires the extension KHR_node_visibility"));
  EXPECT_THAT(fault_with("CESIUM_RTC"), HasSubstr("requires the extension CESIUM_RTC"));
  for (const char* compression :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"})
    EXPECT_THAT(fault_with(compression), HasSubstr(std::string("compressed with ") + compression));
  EXPECT_THAT(fault_with(R"(\u001b[31m)" + std::string(1000, 'x')),
              HasSubstr(R"(the extension \u001b[31m)" + std::string(59, 'x') + "...,"));
}

// Extensions that are merely used may hold all of the data.
TEST(GltfExtensions, DataThatAreOnlyCompressedAreNamed) {
  CubeModel model;
  model.attributes = R"("POSITION":)" + model.store.accessor(GltfStore::kVec3, 8, R"("min":[0,0,0])");
  model.more = R"(,"extensionsUsed":["KHR_draco_mesh_compression"])";
  EXPECT_THAT(model.fault(R"({"mesh":0})"), HasSubstr("has no data"));
  model.targets =
      R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}})";
  EXPECT_THAT(model.fault(R"({"mesh":0})"), HasSubstr("compressed with KHR_draco_mesh_compression"));
  // With data of its own, the primitive is read.
  model.attributes = R"("POSITION":0)";
  EXPECT_NEAR(volume(model.read(R"({"mesh":0})")), 1, 1e-14);

  GltfStore store;
  store.vec3(unit_cube().positions);
  store.corners(unit_cube());
  std::string json = store.json(
      R"("extensionsUsed":["EXT_meshopt_compression"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])",
      R"(,"extensions":{"EXT_meshopt_compression":{"fallback":true}})");
  const std::string view = R"({"buffer":0)";
  for (std::size_t at = 0; (at = json.find(view, at)) != std::string::npos; at += view.size())
    json.replace(
        at, view.size(),
        R"({"extensions":{"EXT_meshopt_compression":{"buffer":1,"byteLength":9,"count":8}},"buffer":0)");
  EXPECT_THAT(fault_of("a.gltf", json), HasSubstr("compressed with EXT_meshopt_compression"));
}

TEST(GltfVersion, OneIsNamed) {
  const char* const documents[] = {
      R"({"asset":{"version":1.0},"meshes":[]})",   R"({"asset":{"version":1},"meshes":[]})",
      R"({"asset":{"version":"1.0"},"meshes":[]})", R"({"asset":{"version":"1.1"},"meshes":{"a":{}}})",
      R"({"meshes":{"a":{"primitives":[]}}})",      R"({"asset":{"version":1.1},"meshes":{"a":{}}})"};
  for (const char* document : documents)
    EXPECT_THAT(fault_of("a.gltf", document),
                ::testing::ContainsRegex("^glTF version 1.* is not supported, only version 2"));
  EXPECT_THAT(fault_of("a.gltf", R"({"asset":{"version":"2.0","minVersion":"2.1"}})"),
              HasSubstr("glTF version 2.1 is not supported"));
}

}  // namespace
}  // namespace sdm

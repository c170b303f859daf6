// Animations of nodes and skins in glTF files, compared with closed forms.
#include <gmock/gmock.h>
#include <sdm/mesh_files.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "io_read/gltf_store.h"
#include "io_read/writers.h"
#include "support/error_of.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::HasSubstr;

constexpr double kSingle = 1e-6;  // what single precision of the files leaves
constexpr double kQuarter = std::numbers::pi / 2;

/// A closed bar along x from 0 to 2, in four pieces, 0.5 wide.
Mesh bar() {
  Mesh mesh;
  for (int i = 0; i <= 4; ++i)
    for (const auto& [y, z] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {0.5, 0.5}, {0.0, 0.5}})
      mesh.positions.push_back({0.5 * i, y, z});
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  quad(3, 2, 1, 0);
  for (std::uint32_t i = 0; i < 16; i += 4)
    for (std::uint32_t k = 0; k < 4; ++k) quad(i + k, i + (k + 1) % 4, i + 4 + (k + 1) % 4, i + 4 + k);
  quad(16, 17, 18, 19);
  return mesh;
}

Vec3 about_z(const Vec3& p, double angle) {
  return {std::cos(angle) * p[0] - std::sin(angle) * p[1], std::sin(angle) * p[0] + std::cos(angle) * p[1],
          p[2]};
}
/// The quaternion of a turn about z.
std::vector<float> z_quaternion(double angle) {
  return {0, 0, static_cast<float>(std::sin(angle / 2)), static_cast<float>(std::cos(angle / 2))};
}
std::vector<float> z_quaternions(const std::vector<double>& angles) {
  std::vector<float> all;
  for (const double angle : angles)
    for (const float x : z_quaternion(angle)) all.push_back(x);
  return all;
}

/// A document with the bar as mesh 0, and an animation.
struct MovingBar {
  GltfStore store;
  std::string attributes = R"("POSITION":)" + store.vec3(bar().positions);
  std::string indices = store.corners(bar());
  std::string of_primitive{}, more{};  ///< further members, which begin with a comma
  JsonList samplers{}, channels{};

  void animate(int node, const std::string& path, const std::vector<float>& times,
               const std::vector<float>& values, const std::string& interpolation = "LINEAR") {
    const std::size_t columns = path == "rotation" ? 4 : path == "weights" ? 1 : 3;
    const std::string input = store.scalars(times),
                      output = store.rows<float>(columns == 4   ? "VEC4"
                                                 : columns == 3 ? "VEC3"
                                                                : "SCALAR",
                                                 values.size() / columns, values);
    const std::string sampler = samplers.add(R"("input":)" + input + R"(,"output":)" + output +
                                             R"(,"interpolation":")" + interpolation + '"');
    channels.add(R"("sampler":)" + sampler + R"(,"target":{"node":)" + std::to_string(node) + R"(,"path":")" +
                 path + R"("})");
  }
  /// `before`: other animations, each with a comma after it.
  [[nodiscard]] std::string glb(const std::string& nodes, const std::string& before = "") const {
    return store.glb(R"("nodes":[)" + nodes + R"(],"meshes":[{"primitives":[{"attributes":{)" + attributes +
                     R"(},"indices":)" + indices + of_primitive + "}]}]" + more + R"(,"animations":[)" +
                     before + R"({"channels":[)" + channels.text + R"(],"samplers":[)" + samplers.text +
                     "]}]");
  }
  [[nodiscard]] MeshSequence sequence(const std::string& nodes, std::optional<double> rate = {}) const {
    return MeshSequence(write_file("bar.glb", glb(nodes)).string(), {.rate = rate});
  }
  [[nodiscard]] std::string fault(const std::string& nodes) const {
    return error_of([&] {
      MeshSequence frames = sequence(nodes);
      for (std::size_t t = 0; t < frames.frame_count(); ++t) (void)frames.positions(t);
    });
  }
};

/// `place`: of a vertex, by its rest and the number of the frame.
void expect_placed(MeshSequence& sequence, std::size_t frames,
                   const std::function<Vec3(const Vec3& rest, double frame)>& place) {
  ASSERT_EQ(sequence.frame_count(), frames);
  EXPECT_EQ(sequence.mesh().triangles, bar().triangles);
  for (std::size_t t = 0; t < frames; ++t) {
    const auto positions = sequence.positions(t);
    ASSERT_EQ(positions.size(), bar().positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v)
      EXPECT_LT(norm(positions[v] - place(bar().positions[v], static_cast<double>(t))), kSingle)
          << "vertex " << v << " of frame " << t;
  }
}

TEST(GltfAnimation, ABarTurnsAtAConstantRate) {
  MovingBar model;
  model.animate(0, "rotation", {0, 1}, z_quaternions({0, kQuarter}));
  MeshSequence sequence = model.sequence(R"({"mesh":0,"translation":[3,0,0],"scale":[2,1,1]})", 10);
  expect_placed(sequence, 11, [](const Vec3& p, double t) {
    return about_z({2 * p[0], p[1], p[2]}, kQuarter * t / 10) + Vec3{3, 0, 0};
  });
}

// A quaternion and its negative are the same rotation; neither needs the length 1.
TEST(GltfAnimation, RotationsTakeTheShorterArc) {
  MovingBar model;
  std::vector<float> values = z_quaternions({0, kQuarter, 2 * kQuarter});
  for (std::size_t i = 4; i < 8; ++i) values[i] *= -3;
  model.animate(0, "rotation", {1, 2, 3}, values);
  MeshSequence sequence = model.sequence(R"({"mesh":0})", 4);
  expect_placed(sequence, 9, [](const Vec3& p, double t) { return about_z(p, kQuarter * t / 4); });
  // From one rotation to nearly the same.
  MovingBar still;
  still.animate(0, "rotation", {0, 1}, z_quaternions({1, 1}));
  MeshSequence at_rest = still.sequence(R"({"mesh":0})", 2);
  expect_placed(at_rest, 3, [](const Vec3& p, double) { return about_z(p, 1); });
}

TEST(GltfAnimation, NormalizedRotations) {
  MovingBar model;
  std::vector<double> numbers;
  for (const float x : z_quaternions({0, kQuarter})) numbers.push_back(std::round(32767 * x));
  const std::string input = model.store.scalars({0, 1}),
                    output =
                        model.store.rows<std::int16_t>("VEC4", 2, numbers, 5122, R"(,"normalized":true)");
  model.samplers.add(R"("input":)" + input + R"(,"output":)" + output);
  model.channels.add(R"("sampler":0,"target":{"node":0,"path":"rotation"})");
  MeshSequence sequence = model.sequence(R"({"mesh":0})", 2);
  ASSERT_EQ(sequence.frame_count(), 3u);
  for (std::size_t v = 0; v < bar().positions.size(); ++v)
    EXPECT_LT(norm(sequence.positions(1)[v] - about_z(bar().positions[v], kQuarter / 2)), 1e-4);
}

// The spline through 0 and 1 with the slopes 0 and 2 is t²; a step stays until the next key.
TEST(GltfAnimation, StepsAndSplines) {
  MovingBar model;
  model.animate(0, "translation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0},
                "CUBICSPLINE");
  model.animate(0, "scale", {0, 0.5f, 1}, {1, 1, 1, 1, 2, 1, 1, 4, 1}, "STEP");
  MeshSequence sequence = model.sequence(R"({"mesh":0})", 4);
  expect_placed(sequence, 5, [](const Vec3& p, double t) {
    const double y = t < 2 ? 1 : t < 4 ? 2 : 4;
    return Vec3{p[0] + t * t / 16, y * p[1], p[2]};
  });
}

// A spline of quaternions is made a rotation again: halfway between two that differ by 90°, with slopes of 0.
TEST(GltfAnimation, SplinesOfRotations) {
  MovingBar model;
  const std::vector<float> none(4, 0), a = z_quaternion(0), b = z_quaternion(kQuarter);
  std::vector<float> values;
  for (const auto* row : {&none, &a, &none, &none, &b, &none})
    values.insert(values.end(), row->begin(), row->end());
  model.animate(0, "rotation", {0, 2}, values, "CUBICSPLINE");
  MeshSequence sequence = model.sequence(R"({"mesh":0})", 1);
  expect_placed(sequence, 3, [](const Vec3& p, double t) { return about_z(p, kQuarter * t / 2); });
}

// Keys are those of all channels; a channel stays at its first and last value.
TEST(GltfAnimation, ParentsCarryChildren) {
  MovingBar model;
  model.animate(0, "translation", {0, 1}, {0, 0, 0, 0, 0, 4});
  model.animate(2, "rotation", {1, 2}, z_quaternions({0, kQuarter}));
  MeshSequence sequence =
      model.sequence(R"({"children":[1]},{"children":[2],"translation":[1,0,0],"scale":[1,1,2]},{"mesh":0})");
  expect_placed(sequence, 3, [](const Vec3& p, double t) {
    const Vec3 q = about_z(p, kQuarter * std::max(0.0, t - 1));
    return Vec3{q[0] + 1, q[1], 2 * q[2] + 4 * std::min(t, 1.0)};
  });
  EXPECT_EQ(sequence.frame_name(2), "bar.glb at 2 s");
}

TEST(GltfAnimation, InstancesMoveWithTheirNode) {
  MovingBar model;
  model.animate(0, "translation", {0, 1}, {0, 0, 0, 0, 0, 4});
  const std::string places = model.store.vec3({{0, 5, 0}, {0, 9, 0}});
  MeshSequence sequence = model.sequence(
      R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" + places + "}}}}");
  const auto positions = sequence.positions(1);
  ASSERT_EQ(positions.size(), 40u);
  for (std::size_t v = 0; v < 40; ++v)
    EXPECT_EQ(positions[v], (bar().positions[v % 20] + Vec3{0, v < 20 ? 5.0 : 9.0, 4}));
}

/// The bar with a skin: joint 0 holds it up to x = 1, joint 1, bound at x = 1, from x = 1.5; at 1 they share.
struct BendingBar : MovingBar {
  static double share(const Vec3& p) { return p[0] < 1 ? 0 : p[0] > 1 ? 1 : 0.25; }

  BendingBar() {
    std::vector<int> joints;
    std::vector<double> weights;
    for (const Vec3& p : bar().positions) {
      joints.insert(joints.end(), {0, 1, 0, 0});
      weights.insert(weights.end(), {1 - share(p), share(p), 0, 0});
    }
    attributes += R"(,"JOINTS_0":)" + store.rows<std::uint8_t>("VEC4", 20, joints, 5121) +
                  R"(,"WEIGHTS_0":)" + store.rows<float>("VEC4", 20, weights);
    const std::vector<double> bind{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
    more = R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":)" + store.rows<float>("MAT4", 2, bind) + "}]";
  }
  /// The second joint turned by an angle, the first moved up.
  static Vec3 bent(const Vec3& p, double angle, double up) {
    const Vec3 moved = about_z(p - Vec3{1, 0, 0}, angle) + Vec3{1, 0, 0};
    return (1 - share(p)) * p + share(p) * moved + Vec3{0, 0, up};
  }
};

// The node with the mesh has no effect, even where it moves (glTF 2.0, 3.7.3).
constexpr const char* kSkeleton =
    R"({"mesh":0,"skin":0,"translation":[7,7,7]},{"children":[2]},{"translation":[1,0,0]})";

TEST(GltfAnimation, ASkinBends) {
  BendingBar model;
  model.animate(0, "translation", {0, 1}, {0, 0, 0, 9, 9, 9});
  model.animate(1, "translation", {0, 1}, {0, 0, 0, 0, 0, 2});
  model.animate(2, "rotation", {0, 1}, z_quaternions({0, kQuarter}));
  MeshSequence sequence = model.sequence(kSkeleton, 5);
  expect_placed(sequence, 6,
                [](const Vec3& p, double t) { return BendingBar::bent(p, kQuarter * t / 5, 2 * t / 5); });
}

TEST(GltfAnimation, MorphTargetsApplyBeforeTheSkin) {
  for (const bool animated : {true, false}) {
    BendingBar model;
    std::vector<Vec3> wide;
    for (const Vec3& p : bar().positions) wide.push_back({0, p[1], 0});
    model.of_primitive = R"(,"targets":[{"POSITION":)" + model.store.vec3(wide) + "}]";
    if (animated) model.animate(0, "weights", {0, 1}, {0, 2});
    model.animate(2, "rotation", {0, 1}, z_quaternions({0, kQuarter}));
    const std::string nodes =
        R"({"mesh":0,"skin":0,"weights":[0.5]},{"children":[2]},{"translation":[1,0,0]})";
    MeshSequence sequence = model.sequence(nodes, 4);
    expect_placed(sequence, 5, [&](const Vec3& p, double t) {
      const double weight = animated ? 2 * t / 4 : 0.5;
      return BendingBar::bent({p[0], (1 + weight) * p[1], p[2]}, kQuarter * t / 4, 0);
    });
  }
}

// What a single mesh is read as, is a frame whose keys are as the nodes are in the file.
TEST(GltfAnimation, AtItsRestAFileIsWhatItsMeshIs) {
  BendingBar model;
  model.animate(2, "rotation", {0, 1}, z_quaternions({0.3, 0.3}));
  const std::string nodes =
      R"({"mesh":0,"skin":0},{"children":[2]},{"translation":[1,0,0],"rotation":[0,0,)" +
      text(static_cast<float>(std::sin(0.15))) + "," + text(static_cast<float>(std::cos(0.15))) + "]}";
  MeshSequence sequence = model.sequence(nodes);
  const Mesh mesh = read_as("bar.glb", model.glb(nodes));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_LT(norm(sequence.positions(1)[v] - mesh.positions[v]), 1e-14);
}

double enclosed_volume(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += dot(cross(mesh.positions[a], mesh.positions[b]), mesh.positions[c]);
  return six / 6;
}

// The outside is that of the first frame, wherever the file has the node.
TEST(GltfAnimation, AMirroredFirstFrameKeepsTheOutside) {
  MovingBar model;
  model.animate(0, "scale", {0, 1}, {-1, 1, 1, -2, 1, 1});
  EXPECT_NEAR(enclosed_volume(model.sequence(R"({"mesh":0})").mesh()), enclosed_volume(bar()), kSingle);
  EXPECT_GT(enclosed_volume(bar()), 0);
}

// Two bodies that touch in the first frame may part, but those that nothing moves are one.
TEST(GltfAnimation, OnlyWhatMovesTogetherIsWelded) {
  MovingBar model;
  const std::string nodes =
      R"({"mesh":0,"translation":[2,0,0]},{"mesh":0},{"mesh":0,"translation":[-2,0,0]})";
  model.animate(0, "translation", {0, 1}, {2, 0, 0, 3, 0, 0});
  MeshSequence sequence = model.sequence(nodes);
  EXPECT_EQ(sequence.mesh().positions.size(), 20u + 36u);
  EXPECT_EQ(sequence.positions(1)[0], (Vec3{3, 0, 0}));
  EXPECT_EQ(sequence.positions(1)[20], (Vec3{0, 0, 0}));
  // One node above them moves all: they stay together.
  MovingBar together;
  together.animate(3, "translation", {0, 1}, {0, 0, 0, 3, 0, 0});
  EXPECT_EQ(together.sequence(nodes + R"(,{"children":[0,1,2]})").mesh().positions.size(), 52u);
}

// Channels of extensions are not of nodes: of several animations, the first that changes something.
TEST(GltfAnimation, TheFirstThatChangesSomething) {
  MovingBar model;
  model.animate(0, "translation", {0, 1}, {0, 0, 0, 0, 0, 4});
  std::string contents =
      model.glb(R"({"mesh":0})", R"({"channels":[{"sampler":0,"target":{"path":"pointer"}}]},)");
  MeshSequence sequence(write_file("bar.glb", contents).string());
  EXPECT_EQ(sequence.positions(1)[0], (Vec3{0, 0, 4}));
}

TEST(GltfAnimation, FaultsAreNamed) {
  const auto fault = [](const std::string& path, const std::vector<float>& times,
                        const std::vector<float>& values, const std::string& node = R"({"mesh":0})",
                        int moved = 0) {
    MovingBar model;
    model.animate(moved, path, times, values);
    return model.fault(node);
  };
  const std::vector<float> still{0, 0, 0, 0, 0, 0};
  EXPECT_EQ(fault("translation", {0, 1}, still), "");
  EXPECT_THAT(fault("translation", {0, 1, 2}, still), HasSubstr("6 numbers for 3 keys of translation"));
  EXPECT_THAT(fault("rotation", {0, 1}, {0, 0, 0, 1}), HasSubstr("4 numbers for 2 keys of rotation"));
  EXPECT_THAT(fault("rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 0}), HasSubstr("quaternion of length 0"));
  EXPECT_THAT(fault("scale", {1, 0}, still), HasSubstr("times of the animation do not increase at key 1"));
  EXPECT_THAT(fault("translation", {0, 1}, still, R"({"mesh":0})", 4), HasSubstr("item 4 of nodes"));
  EXPECT_THAT(fault("translation", {0, 1}, still, R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})"),
              HasSubstr("moves node 0, whose transform is a matrix"));
  EXPECT_THAT(fault("translation", {0, 1}, still, R"({"mesh":0},{"camera":0})", 1),
              HasSubstr("does not change any mesh of the scene"));
  EXPECT_THAT(fault("translation", {0, 1}, {0, 0, 0, 0, 0, NAN}), HasSubstr("frame 1 (bar.glb at 1 s)"));
  EXPECT_THAT(fault("translation", {0, 1}, {0, 0, 0, 0, 0, 2e38f}), HasSubstr("frame 1 (bar.glb at 1 s)"));
}

TEST(GltfAnimation, DamagedFilesAreRefused) {
  BendingBar model;
  model.animate(2, "rotation", {0, 1}, z_quaternions({0, kQuarter}));
  const std::string good = model.glb(kSkeleton);
  const auto fault_with = [&](const std::string& from, std::string to) {
    std::string contents = good;
    to.resize(from.size(), ' ');
    const std::size_t place = contents.rfind(from);
    EXPECT_NE(place, std::string::npos) << from;
    contents.replace(place, from.size(), to);
    return error_of([&] { (void)MeshSequence(write_file("bar.glb", contents).string()).positions(0); });
  };
  EXPECT_EQ(fault_with("rotation", "rotation"), "");
  EXPECT_THAT(fault_with("\"sampler\":0", "\"sampler\":7"), HasSubstr("sampler 7"));
  EXPECT_THAT(fault_with("\"node\":2", "\"node\":9"), HasSubstr("item 9 of nodes"));
  EXPECT_THAT(fault_with("\"joints\":[1,2]", "\"joints\":[1,7]"), HasSubstr("joint at node 7"));
  EXPECT_THAT(fault_with("\"joints\":[1,2]", "\"joints\":[1]"), HasSubstr("follows joint 1 of 1"));
  EXPECT_THAT(fault_with("\"path\"", "\"pass\""), HasSubstr("invalid glTF"));
  EXPECT_THAT(fault_with("\"samplers\":[{", "\"samplers\":7,{"), HasSubstr("damaged"));
  EXPECT_THAT(fault_with("\"children\":[2]", "\"children\":[1]"),
              HasSubstr("joint at node 1, which does not exist in any tree"));
  for (const std::size_t cut : {good.size() - 3, good.size() / 2, std::size_t{30}})
    EXPECT_NE(error_of([&] { MeshSequence(write_file("bar.glb", good.substr(0, cut)).string()); }), "");
}

// A few hundred bytes that declare billions of keys.
TEST(GltfAnimation, KeysThatAreNotStoredAreCharged) {
  MovingBar model;
  const std::string keys = model.store.sparse_vec3({{1, 2, 3}}, std::size_t{1} << 40);
  model.samplers.add(R"("input":)" + keys + R"(,"output":)" + keys);
  model.channels.add(R"("sampler":0,"target":{"node":0,"path":"translation"})");
  EXPECT_THAT(model.fault(R"({"mesh":0})"), HasSubstr("would take"));
}

}  // namespace
}  // namespace sdm

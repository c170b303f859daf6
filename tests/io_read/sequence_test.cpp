// Sequences: every form of input gives the frames that were written; errors name the frame.
#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <fstream>
#include <vector>

#include "io_read/sequences.h"
#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A file in a folder of the test's own.
std::string write(const std::string& name, std::string_view contents) {
  const std::filesystem::path file = write_file("marker", "").parent_path() / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << contents;
  return file.string();
}
/// An empty folder with that name.
std::string fresh(const std::string& name) {
  const std::filesystem::path folder = write_file("marker", "").parent_path() / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string() + "/";
}

std::vector<Vec3> copy(std::span<const Vec3> positions) {
  return {positions.begin(), positions.end()};
}

void expect_frames(MeshSequence& sequence, const Frames& frames) {
  ASSERT_EQ(sequence.frame_count(), frames.size());
  EXPECT_EQ(sequence.mesh().positions, frames[0]);
  for (const std::size_t t : {frames.size() - 1, std::size_t{0}})  // in any order
    EXPECT_EQ(copy(sequence.positions(t)), frames[t]) << sequence.frame_name(t);
  for (std::size_t t = 0; t < frames.size(); ++t)
    EXPECT_EQ(copy(sequence.positions(t)), frames[t]) << sequence.frame_name(t);
}

template <typename Action>
void expect_fault(const Action& action, const std::vector<std::string>& parts) {
  try {
    action();
    ADD_FAILURE() << "nothing was thrown, but " << parts[0] << " was expected";
  } catch (const Error& fault) {
    for (const std::string& part : parts) EXPECT_THAT(fault.what(), HasSubstr(part));
    EXPECT_EQ(std::string(fault.what()).find('\n'), std::string::npos) << fault.what();
  }
}
void expect_refused(const std::string& input, const std::vector<std::string>& parts,
                    const SequenceOptions& options = {}) {
  expect_fault([&] { const MeshSequence sequence(input, options); }, parts);
}

Mesh at(Mesh mesh, const std::vector<Vec3>& positions) {
  mesh.positions = positions;
  return mesh;
}

TEST(Sequence, NumberedFilesOfEveryFormat) {
  const Mesh mesh = torus(8, 4);
  const Frames frames = frames_of(mesh, 3);
  const std::pair<const char*, std::string (*)(const Mesh&)> formats[] = {
      {".obj", obj}, {".off", off}, {".ply", ply_text}, {".stl", stl_binary}, {".glb", glb}, {".3ds", tds}};
  for (const auto& [extension, contents] : formats) {
    SCOPED_TRACE(extension);
    const std::string folder = fresh("numbered");
    for (std::size_t t = 0; t < frames.size(); ++t)
      write("numbered/a" + std::to_string(t) + extension, contents(at(mesh, frames[t])));
    // STL, glTF and 3DS repeat vertices, in the order of faces.
    const Mesh first = read_mesh(folder + "a0" + extension);
    for (const std::string& input : {folder, folder + "a%d" + extension, folder + "a*" + extension}) {
      MeshSequence sequence(input);
      EXPECT_EQ(sequence.mesh().triangles, first.triangles);
      EXPECT_EQ(sequence.mesh().corner_uvs, first.corner_uvs);
      for (std::size_t t = 0; t < frames.size(); ++t)
        EXPECT_EQ(corner_positions(at(first, copy(sequence.positions(t)))),
                  corner_positions(at(mesh, frames[t])));
    }
  }
}

TEST(Sequence, FilesAreSortedByNumber) {
  const Mesh mesh = tetrahedron();
  const Frames frames = frames_of(mesh, 4);
  const std::string folder = fresh("order");
  for (const auto& [t, number] : {std::pair{0, "8"}, {1, "9"}, {2, "10"}, {3, "11"}})
    write(std::string("order/walk_") + number + ".obj", obj(at(mesh, frames[t])));
  write("order/notes.txt", "8");
  write("order/walk.mtl", "");
  std::filesystem::create_directories(folder + "walk_12.obj");  // a folder, not a file
  MeshSequence sequence(folder);
  expect_frames(sequence, frames);
  EXPECT_EQ(sequence.frame_name(2), "walk_10.obj");
}

TEST(Sequence, ChecksumsAreOfAllFilesInTheirOrder) {
  const Mesh mesh = tetrahedron();
  const Frames frames = frames_of(mesh, 3);
  const std::string folder = fresh("checksums");
  std::string all;
  for (const auto& [t, number] : {std::pair{0, "8"}, {1, "9"}, {2, "11"}}) {  // 10 is missing
    all += obj(at(mesh, frames[t]));
    write(std::string("checksums/a") + number + ".obj", obj(at(mesh, frames[t])));
  }
  EXPECT_EQ(MeshSequence(folder).xxh3(), file_xxh3(write("checksums.all", all)));
  EXPECT_EQ(MeshSequence(folder + "a9.obj").xxh3(), file_xxh3(folder + "a9.obj"));
}

TEST(Sequence, PatternsMatchPrintfNames) {
  const Mesh mesh = tetrahedron();
  const std::string folder = fresh("printf");
  const auto add = [&](const std::string& name) { write("printf/" + name, obj(mesh)); };
  add("a08.obj");
  add("a09.obj");
  add("a10.obj");
  add("a7.obj");
  add("a100.obj");
  add("b1.obj");
  add("c99.obj");
  add("c100.obj");
  add("c0101.obj");
  EXPECT_EQ(MeshSequence(folder + "c%02d.obj").frame_count(), 2u);
  expect_refused(folder + "a%02d.obj", {"from 8 to 100, only 4 have a file"});
  EXPECT_EQ(MeshSequence(folder + "b%d.obj").frame_count(), 1u);
  expect_refused(folder + "a%d.obj", {"only 3 have a file"});  // 7, 10 and 100
  expect_refused(folder, {"several sequences", "*.obj"});
  for (const char* pattern : {"a%x.obj", "a%", "a%0d.obj", "a%02", "a%123d.obj"})
    expect_refused(folder + pattern, {pattern, "% must be followed by d"});
  for (const char* pattern : {"a%d%d.obj", "a*.*", "*%d.obj"})
    expect_refused(folder + pattern, {pattern, "only one number"});
  expect_refused(folder + "d%d.obj", {"d%d.obj", "no file matches the pattern"});
  add("a010.obj");
  expect_refused(folder + "a*.obj", {"a010.obj and a10.obj have the same number"});
  add("a99999999999999999999.obj");
  expect_refused(folder + "a*.obj", {"a99999999999999999999.obj", "too large"});
}

TEST(Sequence, StepsAreDetectedAndGapsAreUnreadableFrames) {
  const Mesh mesh = tetrahedron();
  const Frames frames = frames_of(mesh, 4);
  const std::string folder = fresh("gaps");
  for (const int t : {0, 1, 3})
    write("gaps/" + std::to_string(20 + 10 * t) + ".obj", obj(at(mesh, frames[t])));
  MeshSequence sequence(folder);
  ASSERT_EQ(sequence.frame_count(), 4u);
  expect_fault([&] { (void)sequence.positions(2); }, {folder + ": frame 2 (number 40): there is no file"});
  EXPECT_EQ(copy(sequence.positions(3)), frames[3]);
  expect_fault([&] { (void)sequence.positions(4); }, {"there is no frame 4"});
  expect_refused(fresh("empty"), {"no mesh files whose names end in a number"});
}

TEST(Sequence, MismatchedFramesAreErrorsAndLaterFramesReadable) {
  const Mesh mesh = torus(8, 4);
  const Frames frames = frames_of(mesh, 2);
  Mesh more = mesh, fewer = mesh, turned = mesh, far = mesh;
  more.positions.push_back({});
  fewer.triangles.pop_back();
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  far.positions[3][1] = 1e38;
  std::string nan = obj(mesh);
  nan.replace(0, nan.find('\n'), "v 0 nan 0");
  const std::string folder = fresh("bad");
  const std::vector<std::pair<std::string, std::string>> cases{
      {obj(more), "has 33 vertices, and the first frame has 32"},
      {obj(fewer), "has 63 faces, and the first frame has 64"},
      {obj(turned), "face 5 has other vertices"},
      {obj(far), "vertex 3 has a coordinate beyond 1e37"},
      {nan, "vertex 0 has a NaN or infinite coordinate"},
      {"", "the file is empty"},
  };
  write("bad/0000.obj", obj(mesh));
  write("bad/0002.obj", obj(at(mesh, frames[1])));
  for (const auto& [contents, fault] : cases) {
    write("bad/0001.obj", contents);
    MeshSequence sequence(folder);
    expect_fault([&] { (void)sequence.positions(1); }, {folder + ": frame 1 (0001.obj): ", fault});
    EXPECT_EQ(copy(sequence.positions(2)), frames[1]);
  }
  write("bad/0000.obj", nan);
  expect_refused(folder, {folder + ": 0000.obj: ", "NaN"});
}

TEST(Sequence, WeldedVerticesMustStayTogether) {
  const Mesh mesh = torus(8, 4);
  const Frames frames = frames_of(mesh, 2);
  fresh("weld");
  write("weld/0.stl", stl_binary(mesh));
  write("weld/1.stl", stl_binary(at(mesh, frames[1])));
  Mesh cracked = at(mesh, frames[1]);
  cracked.positions.push_back(cracked.positions[cracked.triangles[40][1]]);
  cracked.positions.back()[2] += 0.25;
  cracked.triangles[40][1] = 32;
  write("weld/2.stl", stl_binary(cracked));
  MeshSequence sequence((write_file("marker", "").parent_path() / "weld").string());
  EXPECT_EQ(sequence.mesh().positions.size(), 32u);
  EXPECT_EQ(corner_positions(at(sequence.mesh(), copy(sequence.positions(1)))),
            corner_positions(at(mesh, frames[1])));
  expect_fault([&] { (void)sequence.positions(2); }, {"frame 2 (2.stl)", "has moved away"});
}

TEST(Sequence, AnyMeshFileIsOneFrame) {
  const Mesh mesh = tetrahedron();
  for (const auto& [name, contents] :
       {std::pair{"rest.off", off(mesh)}, {"rest%d*+a.npy", off(mesh)}, {"7.glb", glb(mesh)}}) {
    MeshSequence sequence(write(name, contents));
    EXPECT_EQ(sequence.frame_count(), 1u);
    EXPECT_EQ(sequence.frame_name(0), name);
    EXPECT_EQ(copy(sequence.positions(0)), sequence.mesh().positions);
    EXPECT_EQ(corner_positions(sequence.mesh()), corner_positions(mesh));
  }
  expect_refused("/no/such/mesh.off", {"/no/such/mesh.off: there is no such file"});
}

TEST(SequenceNpy, EveryLayout) {
  const Mesh mesh = torus(8, 4);
  const Frames frames = frames_of(mesh, 5);
  const std::string file = write("torus+1.obj", obj(mesh));
  for (const std::size_t bytes : {4, 8})
    for (const bool fortran_order : {false, true})
      for (const std::endian order : {std::endian::little, std::endian::big}) {
        MeshSequence sequence(file + "+" + write("motion.npy", npy(frames, {bytes, fortran_order, order})));
        EXPECT_EQ(sequence.mesh().triangles, mesh.triangles);
        expect_frames(sequence, frames);
        EXPECT_EQ(sequence.frame_name(4), "frame 4 of motion.npy");
      }
}

// Arrays in Fortran order that are read in several parts: more bytes than one part has, and columns of more
// frames than that.
TEST(SequenceNpy, LongArraysInFortranOrder) {
  struct Size {
    std::size_t frames;
    Mesh mesh;
  };
  for (const auto& [count, mesh] : {Size{100, torus(300, 100)}, {150'000, tetrahedron()}}) {
    Frames frames(count, mesh.positions);
    for (std::size_t t = 0; t < count; ++t)
      for (Vec3& p : frames[t]) p = (1 + 1e-3 * static_cast<double>(t)) * p;
    const std::string file = write("long.obj", obj(mesh));
    MeshSequence sequence(file + "+" + write("long.npy", npy(frames, {8, true})));
    ASSERT_EQ(sequence.frame_count(), count);
    for (const std::size_t t : {std::size_t{0}, count - 1, count / 2, count / 2 + 1, std::size_t{1}})
      EXPECT_EQ(copy(sequence.positions(t)), frames[t]) << t;
  }
}

TEST(SequenceNpy, FindsTheArrayBesideTheMesh) {
  const Mesh mesh = tetrahedron();
  fresh("beside");
  const std::string file = write("beside/four.off", off(mesh));
  write("beside/motion.npy", npy(frames_of(mesh, 3)));
  EXPECT_EQ(MeshSequence(file + "+motion.npy").frame_count(), 3u);
  expect_refused(file + "+other.npy",
                 {(std::filesystem::path("beside") / "other.npy").string() + ": there is no such file"});
}

// The array is that of the vertices in the file, which may repeat some and not use others.
TEST(SequenceNpy, VerticesAreInFileOrder) {
  const std::string file =
      write("seam.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 0 1\nf 2 3 4\nf 5 4 6\n");
  Frames frames{{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 1}}};
  frames.push_back(frames[0]);
  for (Vec3& p : frames[1]) p[0] += 0.5;
  frames[1][0][0] = std::nan("");
  MeshSequence sequence(file + "+" + write("seam.npy", npy(frames)));
  EXPECT_EQ(copy(sequence.positions(1)),
            (std::vector<Vec3>{{0.5, 0, 0}, {1.5, 0, 0}, {0.5, 1, 0}, {0.5, 0, 1}}));
  frames[1][4][0] = 7;
  MeshSequence apart(file + "+" + write("seam.npy", npy(frames)));
  expect_fault([&] { (void)apart.positions(1); }, {"frame 1 of seam.npy", "vertex 4 has moved away"});
}

TEST(SequenceNpy, ErrorsNameTheFault) {
  const Mesh mesh = tetrahedron();
  const std::string good = npy(frames_of(mesh, 2)), file = write("four.off", off(mesh));
  const auto refuse = [&](const std::string& contents, const std::string& fault) {
    expect_refused(file + "+" + write("x.npy", contents), {"x.npy: ", fault});
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string contents = good;
    contents.replace(contents.find(from), from.size(), to);
    contents[8] = static_cast<char>(static_cast<std::size_t>(contents[8]) + to.size() - from.size());
    return contents;
  };
  refuse("", "not an NPY file");
  refuse("PK", "not an NPY file");
  refuse(good.substr(0, 9), "unexpected end of data");
  refuse(good.substr(0, 40), "unexpected end of data");
  refuse(good.substr(0, good.size() - 1), "truncated");
  refuse(good + "x", "bytes of numbers");
  refuse(with("\1", "\4"), "version 4");
  refuse(with("<f4", "<i4"), "type '<i4', not float32 or float64");
  refuse(with("<f4", "<f2"), "type '<f2'");
  refuse(with("'<f4'", "[('x', '<f4')]"), "records");
  refuse(with("(2, 4, 3)", "(2, 12)"), "the shape (2, 12)");
  refuse(with("(2, 4, 3)", "(2, 3, 4)"), "the shape (2, 3, 4)");
  refuse(with("(2, 4, 3)", "()"), "the shape ()");
  refuse(with("(2, 4, 3)", "(0, 4, 3)"), "no positions");
  refuse(with("(2, 4, 3)", "(2, 5, 3)"), "has 5 vertices per frame, but four.off has 4");
  refuse(with("(2, 4, 3)", "(3, 4, 3)"), "3 frames of 48 bytes");
  refuse(with("(2, 4, 3)", "(384307168202282328, 4, 3)"),
         "384307168202282328 frames");  // 48 times that wraps
  for (const auto& [from, to] : {std::pair{"(2, 4, 3)", "(2, -4, 3)"},
                                 {"(2, 4, 3)", "(2, 4, 3"},
                                 {"'descr'", "'dtype'"},
                                 {"False", "false"},
                                 {", }", "} x"},
                                 {"'shape'", "'descr'"},
                                 {"(2, 4, 3)", "(2 4 3)"}})
    refuse(with(from, to), "the header is not as NumPy writes it");
  expect_refused(write("x.npy", good), {"x.npy: holds positions without triangles"});
  expect_refused(file + "+/no/such.npy", {"/no/such.npy: there is no such file"});
  expect_refused(file + "+/dev.npy/x.npy", {"x.npy: there is no such file"});
  expect_refused("/no/such.obj+" + write("x.npy", good), {"/no/such.obj: there is no such file"});
}

/// Two targets: the tetrahedron's tip moves along x, and its origin by (−1, −2, 0).
const Frames kTargets{{{}, {}, {}, {1, 0, 0}}, {{-1, -2, 0}, {}, {}, {}}};

/// The morphed tetrahedron, within a node that doubles it and moves it by 10 in z.
std::vector<Vec3> morphed(double tip, double origin) {
  std::vector<Vec3> positions = tetrahedron().positions;
  positions[3][0] += tip;
  positions[0][0] -= origin;
  positions[0][1] -= 2 * origin;
  for (Vec3& p : positions) p = {2 * p[0], 2 * p[1], 2 * p[2] + 10};
  return positions;
}
constexpr const char* kPlace = R"(,"scale":[2,2,2],"translation":[0,0,10])";

TEST(SequenceGltf, WeightsAtTheKeys) {
  for (const bool sparse : {false, true})
    for (const char* interpolation : {"STEP", "LINEAR"}) {
      MeshSequence sequence(write(
          "morph.glb", morph_gltf(tetrahedron(), kTargets,
                                  {interpolation, {0.5f, 1, 3}, {0, 0, 1, 0.5f, 0.25f, 1}}, kPlace, sparse)));
      EXPECT_EQ(sequence.mesh().triangles, tetrahedron().triangles);
      expect_frames(sequence, {morphed(0, 0), morphed(1, 0.5), morphed(0.25, 1)});
      EXPECT_EQ(sequence.frame_name(1), "morph.glb at 1 s");
    }
}

TEST(SequenceGltf, WeightsAtARate) {
  const auto sequence_of = [](const WeightChannel& channel, double rate) {
    return MeshSequence(write("morph.glb", morph_gltf(tetrahedron(), kTargets, channel, kPlace)),
                        {.rate = rate});
  };
  MeshSequence linear = sequence_of({"LINEAR", {1, 2, 3}, {0, 0, 1, 0.5f, 0.5f, 0}}, 4);
  expect_frames(
      linear, {morphed(0, 0), morphed(0.25, 0.125), morphed(0.5, 0.25), morphed(0.75, 0.375), morphed(1, 0.5),
               morphed(0.875, 0.375), morphed(0.75, 0.25), morphed(0.625, 0.125), morphed(0.5, 0)});
  MeshSequence step = sequence_of({"STEP", {1, 2}, {0, 0, 1, 0.5f}}, 2);
  expect_frames(step, {morphed(0, 0), morphed(0, 0), morphed(1, 0.5)});
  // In-tangent, value, out-tangent of each key; halfway, (a + b)/2 + span (out − in)/8.
  MeshSequence cubic = sequence_of({"CUBICSPLINE", {0, 2}, {9, 9, 0, 1, 4, 0, 0, 2, 1, 0, 9, 9}}, 1);
  expect_frames(cubic, {morphed(0, 1), morphed(0.5 + 1, 0.5 - 0.5), morphed(1, 0)});
}

TEST(SequenceGltf, ErrorsNameTheFault) {
  const auto refuse = [](const WeightChannel& channel, const std::string& fault) {
    expect_refused(write("morph.glb", morph_gltf(tetrahedron(), kTargets, channel)), {"morph.glb: ", fault});
  };
  refuse({"SPLINE", {0}, {0, 0}}, "interpolation of the animation is none of");
  refuse({"LINEAR", {}, {}}, "no keys");
  refuse({"LINEAR", {0, 1, 1}, {0, 0, 0, 0, 0, 0}}, "do not increase at key 2");
  refuse({"LINEAR", {0, std::nanf("")}, {0, 0, 0, 0}}, "do not increase at key 1");
  refuse({"LINEAR", {0, 1}, {0, 0, 0}}, "3 weights for 2 keys of 2 targets");
  refuse({"CUBICSPLINE", {0, 1}, {0, 0, 0, 0}}, "4 weights for 2 keys of 2 targets");
  const std::string good = morph_gltf(tetrahedron(), kTargets, {"LINEAR", {0, 1}, {0, 0, 1, 1}});
  const auto refuse_with = [&](const std::string& from, std::string to, const std::string& fault) {
    std::string contents = good;
    to.resize(from.size(), ' ');
    contents.replace(contents.find(from), from.size(), to);
    expect_refused(write("morph.glb", contents), {"morph.glb: ", fault});
  };
  refuse_with("\"weights\"", "\"rotate\"", "does not change any mesh");
  refuse_with("\"node\":0", "\"node\":1", "item 1 of nodes is referred to but does not exist");
  refuse_with("\"sampler\":0", "\"sampler\":7",
              "sampler 7 of an animation is referred to but does not exist");
  refuse_with("{\"POSITION\":1}", "{\"POSITION\":3}", "differ in their number of vertices");
  const std::string file = write("morph.glb", good);
  expect_refused(file, {"rate"}, {.rate = -1});
  expect_refused(file, {"rate"}, {.rate = 0});
  expect_refused(file, {"rate"}, {.rate = std::nan("")});
  expect_refused(file, {"more than a billion"}, {.rate = 1e300});
  // An infinite weight is an error of its frame.
  MeshSequence infinite(
      write("inf.glb", morph_gltf(tetrahedron(), kTargets, {"LINEAR", {0, 1}, {0, 0, INFINITY, 1}})));
  expect_fault([&] { (void)infinite.positions(1); }, {"frame 1 (inf.glb at 1 s)", "vertex"});
}

}  // namespace
}  // namespace sdm

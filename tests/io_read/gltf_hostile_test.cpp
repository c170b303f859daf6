// glTF files that refer to what is not theirs, or declare more than they hold.
#include <gmock/gmock.h>
#include <sdm/mesh_files.h>
#include <sys/stat.h>

#include <fstream>
#include <vector>

#include "io_read/gltf_store.h"
#include "io_read/writers.h"
#include "support/error_of.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

namespace fs = std::filesystem;

/// A model in a folder of its own, beside a file that is not its business.
struct GltfUri : ::testing::Test {
  TemporaryFolder outside;
  fs::path folder = outside / "model";
  std::string buffer = gltf_buffer(tetrahedron());

  GltfUri() {
    fs::create_directories(folder / "part");
    write(outside / "secret.bin");
    write(folder / "mine.bin");
    write(folder / "part" / "mine.bin");
  }
  void write(const fs::path& file) const { std::ofstream(file, std::ios::binary) << buffer; }
  [[nodiscard]] std::string fault(const std::string& uri) const {
    std::ofstream(folder / "a.gltf") << gltf_json(tetrahedron(), R"([{"mesh":0}])",
                                                  R"(,"uri":")" + uri + '"');
    return error_of([&] { return read_mesh(folder / "a.gltf"); });
  }
  void expect_refused(const std::string& uri, const std::string& reason) const {
    EXPECT_THAT(fault(uri), AllOf(HasSubstr("a.gltf: the buffer '"), HasSubstr("is refused: " + reason)))
        << uri;
  }
};

TEST_F(GltfUri, FilesInTheFolderAreRead) {
  for (const char* uri : {"mine.bin", "./mine.bin", "part/mine.bin", "part//mine.bin", "m%69ne.bin",
                          "part%2Fmine.bin", "./part/./mine.bin"})
    EXPECT_EQ(fault(uri), "") << uri;
  // Names that only look like others.
  for (const char* name : {"..mine.bin", "a..b", "%2e%2e", "...", "1:2", "a b"}) {
    write(folder / name);
    const std::string uri = name == std::string("%2e%2e") ? "%252e%252e"
                            : name == std::string("1:2")  ? "./1:2"
                                                          : name;
    EXPECT_EQ(fault(uri), "") << uri;
  }
}

TEST_F(GltfUri, TheFolderMayBeALinkOrRelative) {
  ASSERT_EQ(fault("mine.bin"), "");
  fs::create_directory_symlink(folder, outside / "link");
  EXPECT_EQ(error_of([&] { return read_mesh(outside / "link" / "a.gltf"); }), "");
  EXPECT_EQ(error_of([&] { return read_mesh(folder / "part" / ".." / "a.gltf"); }), "");
  EXPECT_EQ(error_of([&] { return read_mesh(fs::relative(folder / "a.gltf")); }), "");
}

TEST_F(GltfUri, PathsThatLeaveTheFolderAreRefused) {
  for (const char* uri :
       {"../secret.bin", "%2e%2e/secret.bin", ".%2E/secret.bin", "..%2fsecret.bin", "part/../../secret.bin",
        "part/../mine.bin", "..", "part/..", "./../model/mine.bin"})
    expect_refused(uri, "it contains \"..\"");
  for (const std::string& uri :
       {(outside / "secret.bin").string(), (folder / "mine.bin").string(), std::string("//host/x"),
        std::string("%2Fetc/passwd"), std::string("/dev/zero")})
    expect_refused(uri, "it is absolute");
  for (const char* uri : {"file:///etc/passwd", "http://host/x", "https://host/x", "%66ile:///etc/passwd",
                          "file%3A///etc/passwd", "C:/secret.bin", "blob:x", "FILE:/x", "a+b-c.1:x"})
    expect_refused(uri, "it has a scheme");
  for (const char* uri :
       {R"(C:\\secret.bin)", R"(..\\secret.bin)", "..%5Csecret.bin", R"(\\\\host\\x)", "a%5cb"})
    expect_refused(uri, "it contains a backslash");
  expect_refused("mine.bin%00.txt", "it contains a NUL");
  expect_refused("mine.bin\\u0000", "it contains a NUL");
  expect_refused("", "it is empty");
}

TEST_F(GltfUri, LinksThatLeaveTheFolderAreRefused) {
  fs::create_symlink(outside / "secret.bin", folder / "absolute.bin");
  fs::create_symlink("../secret.bin", folder / "relative.bin");
  fs::create_symlink("relative.bin", folder / "chain.bin");
  fs::create_directory_symlink(outside.path(), folder / "up");
  for (const char* uri :
       {"absolute.bin", "relative.bin", "chain.bin", "up/secret.bin", "up/model/../secret.bin"})
    EXPECT_THAT(fault(uri), HasSubstr("is refused: it ")) << uri;
  expect_refused("up/secret.bin", "it is a link to a place outside");
  // A folder whose name begins like that of the model.
  fs::create_directory(outside / "model2");
  write(outside / "model2" / "secret.bin");
  fs::create_directory_symlink(outside / "model2", folder / "sibling");
  expect_refused("sibling/secret.bin", "it is a link to a place outside");
  // A link within the folder.
  fs::create_symlink("part/mine.bin", folder / "inside.bin");
  EXPECT_EQ(fault("inside.bin"), "");
}

TEST_F(GltfUri, OnlyRegularFilesAreRead) {
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(fault("pipe"), HasSubstr("buffer 'pipe': this is not a regular file"));
  EXPECT_THAT(fault("part"), HasSubstr("buffer 'part': this is a folder"));
  fs::create_symlink("/dev/zero", folder / "zero");
  expect_refused("zero", "it is a link to a place outside");
  fs::create_symlink("loop", folder / "loop");
  EXPECT_NE(fault("loop"), "");
  EXPECT_THAT(fault("missing.bin"), HasSubstr("buffer 'missing.bin': there is no such file"));
}

TEST_F(GltfUri, TheirTextIsEscapedAndCut) {
  for (const char* text : {R"(\u001b[31m\u009b\r\n\u202e)", "%1b[31m%c2%9b%0d%0a%e2%80%ae"}) {
    const std::string message = fault(text);
    EXPECT_THAT(message, HasSubstr(R"('\u001b[31m\u009b\u000d\u000a\u202e')"));
    EXPECT_EQ(message.find_first_of("\x1b\r\n\xc2"), std::string::npos) << message;
  }
  EXPECT_THAT(fault("%ff"), HasSubstr(R"('\xff')"));
  EXPECT_LT(fault(std::string(100000, 'x')).size(), 1000u);
}

/// The message for a model whose mesh has these accessors.
std::string fault_with(const GltfStore& store, const std::string& nodes, const std::string& primitive,
                       const std::string& more = "") {
  const std::string contents =
      store.glb(R"("nodes":[)" + nodes + R"(],"meshes":[{"primitives":[{)" + primitive + "}]}]" + more);
  EXPECT_LT(contents.size(), 5000u);
  return error_of([&] { return MeshSequence(write_file("a.glb", contents).string()); });
}

// A few hundred bytes that declare billions of rows, of which they store one.
TEST(GltfBudget, RowsThatAreNotStoredAreCharged) {
  for (const std::size_t declared :
       {std::size_t{1} << 24, std::size_t{1} << 31, std::size_t{1} << 40, SIZE_MAX}) {
    GltfStore store;
    const std::string box = store.vec3(cube().positions), faces = store.corners(cube()),
                      zeros = store.sparse_vec3({{1, 2, 3}}, declared), end = R"(,"indices":)" + faces;
    EXPECT_THAT(fault_with(store, R"({"mesh":0})", R"("attributes":{"POSITION":)" + zeros + "}" + end),
                ::testing::AnyOf(HasSubstr("would take"), HasSubstr("more than 2^32")));
    const std::string cube_primitive = R"("attributes":{"POSITION":)" + box + "}" + end;
    EXPECT_THAT(
        fault_with(store,
                   R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
                       zeros + "}}}}",
                   cube_primitive),
        ::testing::AnyOf(HasSubstr("would take"), HasSubstr("more than 2^32")));
    EXPECT_THAT(
        fault_with(
            store, R"({"mesh":0})", cube_primitive,
            R"(,"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":)" +
                zeros + R"(,"output":)" + zeros + "}]}]"),
        HasSubstr("would take"));
  }
}

// Nothing is allocated for a morph target, whatever it declares: as many targets as bytes permit.
TEST(GltfBudget, SparseMorphTargetsTakeWhatTheyStore) {
  GltfStore store;
  const Mesh mesh = sphere(5);
  const std::string positions = store.vec3(mesh.positions), faces = store.corners(mesh),
                    target = store.sparse_vec3({{1, 0, 0}}, mesh.positions.size());
  std::string targets = R"({"POSITION":)" + target + "}", weights = "1";
  for (int i = 1; i < 3000; ++i) {
    targets += R"(,{"POSITION":)" + target + "}";
    weights += ",0";
  }
  const Mesh read =
      read_as("a.glb", store.glb(R"("nodes":[{"mesh":0,"weights":[)" + weights +
                                 R"(]}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" + positions +
                                 R"(},"indices":)" + faces + R"(,"targets":[)" + targets + "]}]}]"));
  EXPECT_EQ(read.positions.size(), mesh.positions.size());
}

// The scene is the product of nodes, primitives and rows.
TEST(GltfBudget, CopiesAreCharged) {
  GltfStore store;
  const Mesh mesh = sphere(4);
  const std::string positions = store.vec3(mesh.positions), faces = store.corners(mesh);
  const std::string primitive = R"({"attributes":{"POSITION":)" + positions + R"(},"indices":)" + faces + "}";
  std::string nodes = R"({"mesh":0})", primitives = primitive;
  for (int i = 1; i < 1000; ++i) {
    nodes += R"(,{"mesh":0})";
    primitives += "," + primitive;
  }
  EXPECT_THAT(fault_of("a.glb", store.glb(R"("nodes":[)" + nodes + R"(],"meshes":[{"primitives":[)" +
                                          primitives + "]}]")),
              AllOf(HasSubstr("the scene"), Not(HasSubstr("not enough memory"))));
}

TEST(GltfBudget, ABufferIsReadOnce) {
  const TemporaryFolder folder;
  const Mesh mesh = tetrahedron();
  std::string buffer = gltf_buffer(mesh);
  const std::size_t length = buffer.size();
  fs::create_directory(folder / "part");
  {
    std::ofstream(folder / "big.bin", std::ios::binary) << buffer;
    fs::resize_file(folder / "big.bin", std::size_t{32} << 20);
  }
  // 32 MB by 1000 names would take 32 GB.
  std::string json = gltf_json(mesh, R"([{"mesh":0}])", R"(,"uri":"big.bin")");
  const std::string entry = R"({"byteLength":)" + std::to_string(length) + R"(,"uri":")";
  std::string more;
  for (int i = 0; i < 1000; ++i) more += "," + entry + (i % 2 ? "./big.bin\"}" : "%62ig.bin\"}");
  json.insert(json.rfind(']'), more);
  std::ofstream(folder / "a.gltf") << json;
  EXPECT_EQ(read_mesh(folder / "a.gltf").triangles.size(), mesh.triangles.size());
}

TEST(GltfSparse, IndicesMustIncreaseWithinTheRows) {
  const auto fault = [](const std::vector<std::uint32_t>& rows, int code = 5125) {
    GltfStore store;
    std::string places;
    for (const std::uint32_t r : rows) put(places, r);
    const std::string at = store.view(places), values = store.view(std::string(rows.size() * 12, '\1')),
                      faces = store.corners(single_triangle());
    const std::string positions = store.accessor(
        GltfStore::kVec3, 3,
        R"("sparse":{"count":)" + std::to_string(rows.size()) + R"(,"indices":{"componentType":)" +
            std::to_string(code) + R"(,"bufferView":)" + at + R"(},"values":{"bufferView":)" + values + "}}");
    return fault_with(store, R"({"mesh":0})",
                      R"("attributes":{"POSITION":)" + positions + R"(},"indices":)" + faces);
  };
  EXPECT_THAT(fault({0, 2}), HasSubstr("degenerate"));  // it is read: two vertices of three coincide
  EXPECT_THAT(fault({0, 3}), HasSubstr("beyond its last one"));
  EXPECT_THAT(fault({1, 0}), HasSubstr("do not increase"));
  EXPECT_THAT(fault({1, 1}), HasSubstr("do not increase"));
  EXPECT_THAT(fault({1}, 5126), HasSubstr("not unsigned integers"));
}

}  // namespace
}  // namespace sdm

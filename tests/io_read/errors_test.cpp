// Every fault is reported in one sentence that names the file and the fault.
#include <gmock/gmock.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void expect_fault(const std::string& name, std::string_view contents, const char* fault) {
  EXPECT_THAT(fault_of(name, contents), HasSubstr(fault)) << contents.substr(0, 200);
}

constexpr const char* kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(Errors, FilesThatCannotBeRead) {
  const auto expect_refused = [](const std::filesystem::path& file, const char* fault) {
    EXPECT_THAT([&] { static_cast<void>(read_mesh(file)); },
                ThrowsMessage<Error>(AllOf(HasSubstr(file.string()), HasSubstr(fault))));
  };
  const std::filesystem::path folder = write_file("a.obj", "").parent_path();
  expect_refused(folder / "missing.obj", "no such file");
  expect_refused("/no/such/folder/a.obj", "no such file");
  expect_refused(folder / "a.obj" / "b.obj", "no such file");
  expect_refused(folder, "is a folder");
  expect_refused("/dev/zero", "not a regular file");
  const std::filesystem::path pipe = folder / "pipe.obj";
  mkfifo(pipe.c_str(), 0600);
  expect_refused(pipe, "not a regular file");
  expect_fault("a.obj", "", "empty");
  if (geteuid() != 0) {
    const std::filesystem::path secret = write_file("secret.obj", kVertices);
    chmod(secret.c_str(), 0);
    expect_refused(secret, "cannot be opened");
  }
}

TEST(Errors, UnknownFormats) {
  const std::string garbage("\x7F\x45\x4C\x46\x02\x01\x01\x00garbage\x00\xFF\xFE", 18);
  expect_fault("a.dat", garbage, "unknown format");
  expect_fault("a", "Dear Sir or Madam", "unknown format");
  expect_fault("a.obj", garbage, "binary data where text is expected");
  expect_fault("a.off", garbage, "binary data where text is expected");
  expect_fault("a.ply", garbage, "must begin with 'ply'");
  expect_fault("a.stl", garbage, "fewer than the header of a binary STL");
  expect_fault("a.stl", garbage + std::string(100, '\xAA'), "truncated or not STL");
  expect_fault("a.3ds", garbage, "does not fit");
  expect_fault("a.glb", garbage, "invalid JSON");
  expect_fault("a.obj", "Dear Sir or Madam", "no triangles");
  expect_fault("a.obj", "# only a comment", "no triangles");
}

TEST(Errors, NoTriangles) {
  expect_fault("a.obj", kVertices, "only a cloud of 3 points");
  expect_fault("a.off", "OFF 3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "only a cloud of 3 points");
  expect_fault("a.off", "OFF 0 0 0\n", "no triangles");
  expect_fault("a.stl", "solid a\nendsolid a\n", "no triangles");
  expect_fault("a.stl", stl_binary({}), "no triangles");
  expect_fault("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
               "z\nend_header\n"
               "0 0 0\n1 1 1\n",
               "only a cloud of 2 points");
  expect_fault("a.gltf", R"({"asset":{"version":"2.0"}})", "no triangles");
  expect_fault("a.obj", std::string(kVertices) + "p 1 2 3\n", "only a cloud of 3 points");
  expect_fault("a.obj", std::string(kVertices) + "f 1 2\nl 1 2 3\n", "only lines (statement l)");
  for (const char* free_form : {"cstype bezier\ndeg 2\ncurv 0 1 1 2 3\nparm u 0 1\nend\n",
                                "cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 1\nend\n"})
    expect_fault("a.obj", std::string(kVertices) + free_form, "only free-form curves and surfaces");
}

TEST(Errors, AllTrianglesDegenerate) {
  expect_fault("a.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 2\n", "all triangles are degenerate");
}

TEST(Errors, NumbersThatAreNotFiniteOrTooLarge) {
  for (const char* bad : {"nan", "-inf", "infinity", "NaN"}) {
    expect_fault("a.obj", std::string(kVertices) + "v 0 0 " + bad + "\nf 1 2 4\n",
                 "vertex 3 has a NaN or infinite");
    expect_fault("a.off", std::string("OFF 3 1 0\n0 0 0\n1 0 ") + bad + "\n0 1 0\n3 0 1 2\n",
                 "vertex 1 has a NaN");
  }
  Mesh mesh = torus(4, 4);
  mesh.positions[5][1] = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& contents :
       {stl_binary(mesh), ply_binary(mesh, std::endian::big), glb(mesh), tds(mesh)})
    expect_fault("a", contents, "has a NaN or infinite coordinate");
  expect_fault("a.obj", std::string(kVertices) + "v 1e999 0 0\n", "line 4: expected a number, not '1e999'");
  expect_fault("a.obj", std::string(kVertices) + "v 1e200 0 0\nf 1 2 4\n", "too large");
}

TEST(Errors, IndicesOutOfRange) {
  expect_fault("a.obj", std::string(kVertices) + "f 1 2 3\nf 1 2 4\n",
               "line 5: index out of range: a face refers to vertex 4 of 3");
  expect_fault("a.obj", std::string(kVertices) + "f 1 2 0\n", "line 4: index out of range");
  expect_fault("a.obj", std::string(kVertices) + "f -1 -2 -4\n", "line 4: index out of range");
  expect_fault("a.obj", std::string(kVertices) + "f 1 2 99999999999\n", "line 4: index out of range");
  expect_fault("a.obj", std::string(kVertices) + "f 1 2 99999999999999999999999\n",
               "line 4: expected a whole number");
  expect_fault("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
               "line 5: index out of range: a face refers to vertex 3 of 3");
  expect_fault("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "vertex -1 of 3");
  Mesh mesh = torus(4, 4);
  mesh.triangles[9][2] = 16;
  expect_fault("a.ply", ply_text(mesh), "index out of range: face 9 refers to vertex 16 of 16");
  mesh.triangles[9][2] = 0xFFFFFFFF;
  expect_fault("a.ply", ply_binary(mesh, std::endian::little),
               "index out of range: row 9 of element face refers to vertex -1");
  std::string contents = tds(torus(4, 4));
  // The last face of the chunk before the texture coordinates.
  contents[contents.size() - 6 - 2 - std::size_t{96} * 8 - 8] = '\x7F';
  expect_fault("a.3ds", contents, "index out of range");
  std::string buffer = gltf_buffer(torus(4, 4));
  buffer[buffer.size() - 2] = 1;
  expect_fault("a.glb", glb(gltf_json(torus(4, 4), R"([{"mesh":0}])", ""), buffer), "index out of range");
}

TEST(Errors, TruncatedFiles) {
  const Mesh mesh = torus(4, 4);
  const auto cut = [](const std::string& whole) { return whole.substr(0, whole.size() * 3 / 4); };
  expect_fault("a.off", cut(off(mesh)), "truncated");
  expect_fault("a.stl", cut(stl_text(mesh)), "truncated");
  expect_fault("a.stl", cut(stl_binary(mesh)), "truncated");
  expect_fault("a.ply", cut(ply_text(mesh)), "truncated");
  expect_fault("a.ply", cut(ply_binary(mesh, std::endian::big)), "truncated");
  expect_fault("a.ply", ply_text(mesh).substr(0, 40), "truncated");
  expect_fault("a.glb", cut(glb(mesh)), "truncated");
  expect_fault("a.3ds", cut(tds(mesh)), "truncated");
  expect_fault("a.gltf", gltf_json(mesh, R"([{"mesh":0}])", "").substr(0, 300), "truncated");
}

TEST(Errors, CountsBeyondTheFile) {
  expect_fault("a.off", "OFF\n4000000000000000000 1 0\n0 0 0\n", "more than the file can hold");
  expect_fault("a.off", "OFF\n1 9223372036854775807 0\n0 0 0\n", "more than the file can hold");
  expect_fault("a.off", "OFF\n-1 1 0\n", "negative");
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 9223372036854775807\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  expect_fault("a.ply", ply + "0123456789", "more than the file can hold");
  expect_fault("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 99\nproperty list uchar int n\nend_header\n0\n",
               "more than the file can hold");
  std::string stl = stl_binary(torus(4, 4));
  stl[83] = '\x7F';
  expect_fault("a.stl", stl, "more than the file");
}

TEST(Errors, ObjStatements) {
  expect_fault("a.obj", "v 0 0\n", "line 1: expected a number");
  expect_fault("a.obj", "v 0 0 0x10\n", "line 1: expected a number, not '0x10'");
  expect_fault("a.obj", "v 0 0 zero\n", "not 'zero'");
  expect_fault("a.obj", "v 0 0 0\nf 1 2 c\n", "line 2: expected a whole number, not 'c'");
  expect_fault("a.obj", "v 0 0 0\nf 1.5 2 3\n", "line 2: expected a whole number");
  expect_fault("a.obj", "v 0 0 0\nf 1 2 \\3\n", "line 2: expected a whole number");
}

TEST(Errors, PlyHeaders) {
  expect_fault("a.ply", "ply\nformat ebcdic 1.0\n", "line 2: expected ascii, binary_little_endian");
  expect_fault("a.ply", "ply\nelement vertex 1\nproperty real x\n",
               "line 3: expected a PLY type, not 'real'");
  expect_fault("a.ply", "ply\nproperty float x\n", "precedes the first element");
  expect_fault("a.ply", "ply\nelement vertex -1\n", "negative");
  expect_fault("a.ply", "ply\nelement vertex\n", "expected a whole number");
  expect_fault("a.ply", "ply\nend_header\n", "has no format");
  expect_fault("a.ply", "ply\nformat ascii 1.0\nnonsense\n", "not 'nonsense'");
  expect_fault(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0 0\n",
      "no z");
  expect_fault("a.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty int vertex_indices\nend_header\n0\n",
               "no list vertex_indices");
}

TEST(Errors, UnsupportedOffVariants) {
  expect_fault("a.off", "nOFF\n4\n1 1 0\n", "nOFF of 4 dimensions; OFF is supported in three");
  expect_fault("a.off", "4nOFF 2\n1 1 0\n", "nOFF of 2 dimensions");
  expect_fault("a.off", "4OFF\n3 1 0\n0 0 0 1\n1 0 0 0\n0 1 0 1\n3 0 1 2\n",
               "vertex 1 has a NaN or infinite");
  expect_fault("a.off", std::string("OFF BINARY\n\0\0\0\1", 15), "binary data");
  expect_fault("a.off", "OFF BINARY\n", "binary OFF is not supported");
}

// No number of one row is taken for one of the next.
TEST(Errors, RowsOfAnotherLength) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::pair<const char*, const char*> ply_rows[] = {
      {"0 0 0\n1 0 0 9\n0 1 0\n3 0 1 2\n",
       "line 11: row 1 of element vertex has more numbers than the header"},
      {"0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 11: row 1 of element vertex has fewer numbers than the header"},
      {"0 0 0 # comment\n1 0 0\n0 1\n3 0 1 2\n", "line 12: row 2 of element vertex has fewer"},
      {"0 0 0\n1 0 0\n0 1 0\n3 0 1 2 2\n", "line 13: row 0 of element face has more"},
      {"0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "truncated"},
      {"0 0 0 1 0 0 0 1 0 3 0 1 2\n",
       "row 0 of element vertex has more numbers than the header declares, or "
       "is not on a line of its own"},
      {"0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "row 0 of element face has a list of -3 items"},
      {"0 0 0\n1 0 0\n0 1 0\n2.5 0 1 2\n", "row 0 of element face has a list of 2.5 items"},
      {"0 0 0\n1 0 0\n0 1 0\n0 1 2\n", "line 13: row 0 of element face has more"}};
  for (const auto& [rows, fault] : ply_rows) expect_fault("a.ply", ply + rows, fault);

  const std::pair<const char*, const char*> off_files[] = {
      {"OFF\n3 1 0\n0 0 0\n1 0 0 255 0 0\n0 1 0\n3 0 1 2\n",
       "line 4: vertex 1 has more numbers than the header"},
      {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
       "line 4: vertex 1 has fewer numbers than the header declares"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 1 1 1 1 1\n", "line 6: face 0 has more numbers"},
      {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n3 0 1 2\n", "index out of range"},
      {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n2 0 1\n", "line 6: face 0 has fewer numbers"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "line 6: face 0 has a negative number of corners"},
      {"NOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 5: vertex 1 has fewer"},
      {"COFF\n3 1 0\n0 0 0 1 1 1 1 1\n1 0 0\n0 1 0\n3 0 1 2\n", "line 3: vertex 0 has more"},
      {"STOFF\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n", "line 3: vertex 0 has fewer"},
      {"OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2", "line 1: more than the counts of vertices, faces and edges"},
      {"OFF\n3 1 0\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n",
       "vertex 0 has more numbers than the header declares, or is "
       "not on a line of its own"},
      {"OFF\n3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 4: vertex 0 has fewer"}};
  for (const auto& [contents, fault] : off_files) expect_fault("a.off", contents, fault);
}

// Text in UTF-16 of either byte order, with or without its mark, of all text formats.
TEST(Errors, Utf16Text) {
  const Mesh mesh = torus(4, 4);
  const std::pair<const char*, std::string> files[] = {{"a.obj", obj(mesh)},
                                                       {"a.off", off(mesh)},
                                                       {"a.stl", stl_text(mesh)},
                                                       {"a.ply", ply_text(mesh)},
                                                       {"a.gltf", gltf_json(mesh, R"([{"mesh":0}])", "")},
                                                       {"a", obj(mesh)}};
  for (const auto& [name, text] : files)
    for (const bool big_endian : {false, true})
      for (const bool mark : {false, true}) {
        std::string wide(mark ? big_endian ? "\xFE\xFF" : "\xFF\xFE" : "");
        for (const char c : text) wide += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
        expect_fault(name, wide, "this is UTF-16 text; save it as UTF-8");
      }
}

// Whatever the extension says.
TEST(Errors, CompressedFiles) {
  using namespace std::string_literals;
  const std::string rest(100, '\x5A');
  for (const char* name : {"a.stl", "a.ply.gz", "a.obj", "a"}) {
    expect_fault(name, "\x1F\x8B\x08" + rest, "is compressed with gzip; decompress it first");
    expect_fault(name, "BZh" + rest, "is compressed with bzip2; decompress it first");
    expect_fault(name, "\xFD" + "7zXZ\0"s + rest, "is compressed with xz; decompress it first");
    expect_fault(name, "\x28\xB5\x2F\xFD" + rest, "is compressed with zstd; decompress it first");
    expect_fault(name, "7z\xBC\xAF\x27\x1C" + rest, "is a 7z archive; extract it first");
    expect_fault(name, "PK\x03\x04" + rest, "is a ZIP archive, as 3MF is; extract or convert it first");
  }
}

// A glTF file with one triangle, some of whose text is replaced.
std::string gltf_with(const std::string& from, const std::string& to) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
  std::string json =
      gltf_json(mesh, R"([{"mesh":0}])", R"(,"uri":"data:;base64,)" + base64(gltf_buffer(mesh)) + '"');
  const std::size_t at = json.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return json.replace(at, from.size(), to);
}

TEST(Errors, Gltf) {
  EXPECT_EQ(fault_of("a.gltf", gltf_with("asset", "asset")), "");
  const std::array<const char*, 3> cases[] = {
      {"\"asset\"", "\"assets\"", "asset is missing"},
      {"2.0", "1.0", "version 2"},
      {"\"2.0\"", "2", "invalid glTF: the version is not text"},
      {"\"mesh\":0", "\"mesh\":1", "item 1 of meshes"},
      {"\"mesh\":0", "\"mesh\":-1", "mesh must be a whole number"},
      {"\"mesh\":0", "\"mesh\":\"0\"", "mesh must be a whole number"},
      {"\"mesh\":0", "\"mesh\":1e300", "mesh must be a whole number"},
      {"\"mesh\":0", "\"mesh\":0,\"children\":[0]", "two parents"},
      {"\"mesh\":0", "\"mesh\":0,\"children\":[7]", "item 7 of nodes"},
      {"\"mesh\":0", "\"mesh\":0,\"matrix\":[1,2]", "invalid glTF"},
      {"\"POSITION\":0", "\"POSITION\":9", "item 9 of accessors"},
      {"\"POSITION\":0", "\"POSITION\":2", "not of type VEC3"},
      {"\"count\":3", "\"count\":4", "extends beyond its buffer view"},
      {"\"count\":3", "\"count\":18446744073709551615", "more than 2^32"},
      {"\"bufferView\":0", "\"bufferView\":0,\"byteOffset\":40", "extends beyond its buffer view"},
      {"\"bufferView\":0", "\"bufferView\":0,\"sparse\":{}", "key 'count' not found"},
      {"\"bufferView\":0,", "", "accessor 0 has no data"},
      {"5126", "9", "component type 9"},
      {"VEC3", "MAT4", "extends beyond its buffer view"},
      {"VEC3", "MAT3", "type MAT3"},
      {"{\"buffer\":0", "{\"buffer\":0,\"byteStride\":0", "extends beyond"},
      {"{\"buffer\":0", "{\"buffer\":0,\"byteStride\":18446744073709551615", "extends beyond"},
      {"{\"buffer\":0", "{\"buffer\":5", "buffer 5"},
      {"\"byteLength\":36", "\"byteLength\":99999", "beyond its buffer"},
      {"\"byteLength\":72", "\"byteLength\":73", "should have 73 bytes but has 72"},
      {"base64,", "base64,!", "not valid base64"},
      {"base64,", "base32,", "not base64"},
      {"data:;base64,", "nowhere.bin?", "no such file"},
      {"\"asset\"", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"",
       "compressed with KHR_draco"},
      {"{\"asset\"", "[{\"asset\"", "invalid JSON"},
      {"{\"asset\"", "{\"a\":\"\xFF\",\"asset\"", "invalid JSON"},
  };
  for (const auto& [from, to, fault] : cases) expect_fault("a.gltf", gltf_with(from, to), fault);
}

TEST(Errors, DeeplyNestedJson) {
  const std::size_t depth = 1000000;
  expect_fault("a.gltf", "{\"a\":" + std::string(depth, '[') + std::string(depth, ']') + "}",
               "asset is missing");
  expect_fault("a.gltf", "{\"a\":" + std::string(depth, '['), "invalid JSON");
  expect_fault(
      "a.gltf",
      R"({"asset":{"version":"2.0"},"extras":)" + std::string(depth, '[') + std::string(depth, ']') + "}",
      "no triangles");
}

// A file that instances one mesh very often requires much more memory than it has bytes.
TEST(Errors, ScenesMuchLargerThanTheirFiles) {
  const Mesh mesh = torus(100, 100);
  std::string nodes = "[{\"children\":[1";
  const int count = 100000;
  for (int n = 2; n < count; ++n) nodes += ',' + std::to_string(n);
  nodes += "]}";
  for (int n = 1; n < count; ++n) nodes += ",{\"mesh\":0}";
  expect_fault("a.glb", glb(gltf_json(mesh, nodes + "]", ""), gltf_buffer(mesh)), "the scene would take");
}

}  // namespace
}  // namespace sdm

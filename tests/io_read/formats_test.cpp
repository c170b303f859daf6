// Round trips of every variant of every format.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "io_read/writers.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;

const std::vector<Vec3> kQuad = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};

void expect_same_shape(const Mesh& read, const Mesh& written) {
  EXPECT_EQ(read.positions.size(), written.positions.size());
  EXPECT_EQ(corner_positions(read), corner_positions(written));
}
void expect_same(const Mesh& read, const Mesh& written) {
  EXPECT_EQ(read.positions, written.positions);
  EXPECT_EQ(read.triangles, written.triangles);
}

// Coordinates that are not representable in single precision.
Mesh precise_torus() {
  Mesh mesh = torus(9, 7);
  for (Vec3& p : mesh.positions) p = {p[0] / 3, p[1] * 1e-20, p[2] * 1e20 / 7};
  return mesh;
}

TEST(Obj, KeepsDoublesOrderAndTextureCoordinates) {
  const Mesh mesh = precise_torus(), read = read_as("a.obj", obj(mesh));
  expect_same(read, mesh);
  EXPECT_EQ(read.corner_uvs, mesh.corner_uvs);
}

TEST(Obj, AllCornerSyntaxes) {
  const std::string vertices = "v 0 0 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 0.5\nvn 0 0 1\n";
  const std::pair<const char*, bool> faces[] = {{"f 1 2 3", false},
                                                {"f 1/1 2/2 3/3", true},
                                                {"f 1//1 2//1 3//1", false},
                                                {"f 1/1/1 2/2/1 3/3/1", true},
                                                {"f -3 -2 -1", false},
                                                {"f -3/-3/-1 -2/-2/-1 -1/-1/-1", true},
                                                {"f 1 2 \\\n 3", false},
                                                {"f 1 2 3 # a comment", false},
                                                {"f 1/ 2/ 3/", false},
                                                {"\tf\t1  2\t3 \r", false},
                                                {"f 1/1 \\\r\n2/2 3/3", true},
                                                {"f 1//  2//1 3", false}};
  for (const auto& [face, has_uvs] : faces) {
    const Mesh read = read_as("a.obj", vertices + face + "\n");
    EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}})) << face;
    EXPECT_EQ(!read.corner_uvs.empty(), has_uvs) << face;
    if (has_uvs) {
      EXPECT_EQ(read.corner_uvs[0], (std::array<Vec2, 3>{{{0, 0}, {1, 0}, {0.5, 0}}})) << face;
    }
  }
}

TEST(Obj, RelativeIndicesCountBackFromTheirLine) {
  const Mesh read = read_as("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 5\nf -4 -3 -1\n");
  EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
}

TEST(Obj, FacesMayPrecedeTheirVertices) {
  EXPECT_EQ(read_as("a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").triangles.size(), 1u);
}

TEST(Obj, SkipsOtherStatements) {
  const Mesh read = read_as(
      "a.obj",
      "\xEF\xBB\xBF# C:\\path\\\nmtllib a.mtl\no thing\ng a b\nusemtl red\ns off\n"
      "v 0 0 0 1 0.5 0.2\nv +1 0 0 1.0\nv 0 1e0 0\nvn 0 0 1\nvp 0 1\nl 1 2\np 1\nf 1 2\ncurv 1\nf 1 2 3");
  EXPECT_EQ(read.positions.size(), 3u);
  EXPECT_EQ(read.triangles.size(), 1u);
}

TEST(Obj, FacesMayHaveAnyNumberOfCorners) {
  std::string vertices, face = "f";
  constexpr int kCorners = 100000;
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2 * std::numbers::pi * k / kCorners, radius = k % 2 ? 1 : 0.999;
    vertices += "v " + text(radius * std::cos(angle)) + ' ' + text(radius * std::sin(angle)) + " 0\n";
    face += ' ' + std::to_string(k + 1);
  }
  EXPECT_EQ(read_as("a.obj", vertices + face + '\n').triangles.size(), kCorners - 2u);
  face = "f";
  for (int k = 0; k < kCorners; ++k) face += std::array{" 1", " 2", " 3"}[k % 3];
  EXPECT_EQ(read_as("a.obj", vertices + face + '\n').positions.size(), 3u);
}

TEST(Obj, AllLineEndings) {
  const Mesh mesh = torus(5, 4);
  for (const char* end : {"\r\n", "\r"}) {
    std::string contents;
    for (const char c : obj(mesh)) contents += c == '\n' ? end : std::string(1, c);
    expect_same(read_as("a.obj", contents), mesh);
  }
}

TEST(Obj, IgnoresTextureCoordinatesOfSomeCornersOnly) {
  EXPECT_TRUE(
      read_as("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 1 2 3\n").corner_uvs.empty());
  EXPECT_TRUE(read_as("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nf 1/1 2/1 3/1\n").corner_uvs.empty());
}

TEST(Off, KeepsDoublesAndOrder) {
  const Mesh mesh = precise_torus();
  expect_same(read_as("a.off", off(mesh)), mesh);
}

TEST(Off, AllVariants) {
  for (const char* contents :
       {"OFF\n4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n",
        "OFF 4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3",
        "# a comment\nOFF # another\n\n4 1\n# more\n0 0 0 # here too\n\n2 0 0\n2 1 "
        "0\n0 1 0\n\n4 0 1 2 3 0.5 0.5 0.5\n",
        "COFF\n4 1 0\n0 0 0 255 0 0 255\n2 0 0 1 1 1 1\n2 1 0 0 0 0 1\n0 1 0 0.5 0.5 "
        "0.5 1\n4 0 1 2 3 255 0 0\n",
        "NOFF\n4 1 0\n0 0 0 0 0 1\n2 0 0 0 0 1\n2 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n",
        "CNOFF\r\n4 1 0\r\n0 0 0 0 0 1 9 9 9\r\n2 0 0 0 0 1 9 9 9\r\n2 1 0 0 0 1 9 9 "
        "9\r\n0 1 0 0 0 1 9 9 9\r\n4 0 1 2 3\r\n",
        "STOFF\n4 1 0\n0 0 0 0 0\n2 0 0 1 0\n2 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n",
        "STCNOFF\n4 1 0\n0 0 0 0 0 1 9 9 9 9 0 0\n2 0 0 0 0 1 9 9 9 1 1 0\n2 1 0 0 0 "
        "1 9 9 1 1\n0 1 0 0 0 1 0 1\n4 0 1 2 3\n",
        "4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n", "OFF4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n",
        "4OFF\n4 1 0\n0 0 0 1\n4 0 0 2\n2 1 0 1\n0 0.5 0 0.5\n4 0 1 2 3\n",
        "nOFF 3\n4 1 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n",
        "4nOFF\n3\n4 1 0\n0 0 0 1\n4 0 0 2\n2 1 0 1\n0 0.5 0 0.5\n4 0 1 2 3\n",
        "OFF\n4\n1 0\n0\n0\n0\n2 0\n0\n2 1 0\n0 1 0\n4 0 1\n2 3\n"}) {
    const Mesh read = read_as("a.off", contents);
    EXPECT_EQ(read.positions, kQuad) << contents;
    ASSERT_EQ(read.triangles.size(), 2u) << contents;
    EXPECT_EQ(read.corner_uvs.size(), std::string(contents).starts_with("ST") ? 2u : 0u) << contents;
    for (std::size_t f = 0; f < read.corner_uvs.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = read.positions[read.triangles[f][k]];
        EXPECT_EQ(read.corner_uvs[f][k], (Vec2{p[0] / 2, p[1]})) << contents;
      }
  }
}

TEST(Off, SkipsPointsAndLines) {
  EXPECT_EQ(
      read_as("a.off", "OFF\n4 4 0\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n1 0\n2 0 1\n0\n3 0 1 2\n").triangles.size(),
      1u);
}

TEST(Stl, TextAndBinaryAreWelded) {
  const Mesh mesh = torus(9, 7);
  expect_same_shape(read_as("a.stl", stl_text(mesh)), mesh);
  expect_same_shape(read_as("b.stl", stl_binary(mesh)), mesh);  // its header begins with "solid"
}

TEST(Stl, NegativeZeroIsZero) {
  const Mesh read =
      read_as("a.stl",
              "SOLID\nFACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\n"
              "ENDFACET\nfacet normal 0 0 0\nouter loop\nvertex -0 0 -0.0\nvertex 0 1 0\nvertex -1 0 0\n"
              "endloop\nendfacet\nendsolid\nsolid\nendsolid\n");
  EXPECT_EQ(read.positions.size(), 4u);
}

TEST(Stl, BinaryMayHaveTrailingBytes) {
  const Mesh mesh = torus(4, 4);
  expect_same_shape(read_as("a.stl", stl_binary(mesh) + "spare"), mesh);
}

TEST(Ply, AllEncodings) {
  const Mesh mesh = precise_torus(), with_seams = torus(8, 4);
  for (const std::string& contents :
       {ply_text(mesh), ply_binary(mesh, std::endian::little), ply_binary(mesh, std::endian::big)})
    expect_same(read_as("a.ply", contents), mesh);
  for (const std::string& contents : {ply_text(with_seams), ply_binary(with_seams, std::endian::little),
                                      ply_binary(with_seams, std::endian::big)}) {
    const Mesh read = read_as("a.ply", contents);
    expect_same(read, with_seams);
    EXPECT_EQ(read.corner_uvs, with_seams.corner_uvs);
  }
}

TEST(Ply, AllTypesAndSkippedPropertiesAndElements) {
  struct Type {
    const char* name;
    void (*put)(std::string&, double, std::endian);
  };
  const Type types[] = {
      {"char", [](std::string& s, double x, std::endian o) { put(s, static_cast<std::int8_t>(x), o); }},
      {"uint8", [](std::string& s, double x, std::endian o) { put(s, static_cast<std::uint8_t>(x), o); }},
      {"short", [](std::string& s, double x, std::endian o) { put(s, static_cast<std::int16_t>(x), o); }},
      {"uint16", [](std::string& s, double x, std::endian o) { put(s, static_cast<std::uint16_t>(x), o); }},
      {"int", [](std::string& s, double x, std::endian o) { put(s, static_cast<std::int32_t>(x), o); }},
      {"uint32", [](std::string& s, double x, std::endian o) { put(s, static_cast<std::uint32_t>(x), o); }},
      {"float32", [](std::string& s, double x, std::endian o) { put(s, static_cast<float>(x), o); }},
      {"double", [](std::string& s, double x, std::endian o) { put(s, x, o); }},
  };
  const auto header = [](const std::string& format, const std::string& t) {
    return "ply\nformat " + format + " 1.0\nobj_info nothing\nelement camera 1\nproperty list uchar " + t +
           " values\nproperty short id\nelement vertex 4\nproperty uchar red\nproperty " + t +
           " z\nproperty list uchar uchar names\nproperty " + t + " x\nproperty " + t +
           " y\nelement face 1\nproperty float quality\nproperty list " + t + " " + t +
           " vertex_index\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  };
  for (const Type& type : types)
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      const std::string t = type.name;
      std::string contents =
          header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian", t);
      put(contents, std::uint8_t{2});
      type.put(contents, 1, order);
      type.put(contents, 2, order);
      put(contents, std::int16_t{7}, order);
      for (const Vec3& p : kQuad) {
        put(contents, std::uint8_t{255});
        type.put(contents, p[2], order);
        contents += std::string("\3abc", 4);
        type.put(contents, p[0], order);
        type.put(contents, p[1], order);
      }
      put(contents, 0.5f, order);
      for (const double x : {4, 0, 1, 2, 3}) type.put(contents, x, order);
      contents += std::string(8, '\0');
      const Mesh read = read_as("a.ply", contents);
      EXPECT_EQ(read.positions, kQuad) << t;
      EXPECT_EQ(read.triangles.size(), 2u) << t;
    }
}

TEST(Ply, TextureCoordinatesOfVertices) {
  const auto contents = [](const std::string& u, const std::string& v) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "property float " +
           u + "\nproperty float " + v +
           "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 0.25 0.5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
  };
  for (const char* names : {"s t", "u v", "texture_u texture_v"}) {
    const std::string n = names;
    const Mesh read = read_as("a.ply", contents(n.substr(0, n.find(' ')), n.substr(n.find(' ') + 1)));
    ASSERT_EQ(read.corner_uvs.size(), 1u);
    EXPECT_EQ(read.corner_uvs[0], (std::array<Vec2, 3>{{{0.25, 0.5}, {1, 0}, {0, 1}}}));
  }
}

TEST(Ply, PropertiesMayBeInUpperCase) {
  const std::string contents =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float X\nproperty float Y\nproperty float Z\n"
      "property float S\nproperty float T\nelement face 1\nproperty list uchar int Vertex_Indices\n"
      "end_header\n0 0 0 0.25 0.5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
  const Mesh read = read_as("a.ply", contents);
  EXPECT_EQ(read.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(read.corner_uvs[0], (std::array<Vec2, 3>{{{0.25, 0.5}, {1, 0}, {0, 1}}}));
}

// A property x in lower case is meant even if another one, such as an index, is named X.
TEST(Ply, LowerCaseTakesPrecedence) {
  const Mesh read =
      read_as("a.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty int X\nproperty float x\nproperty float y\n"
              "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
              "7 0 0 0\n8 1 0 0\n9 0 1 0\n3 0 1 2\n");
  EXPECT_EQ(read.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Ply, RowsMayContinueOnTheNextLine) {
  const Mesh read = read_as(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0\n0\n\n2 0 0\n2 1 0\n0 1 0\n4 0 1\n2 3\n");
  EXPECT_EQ(read.positions, kQuad);
  EXPECT_EQ(read.triangles.size(), 2u);
}

TEST(Ply, FacesMayPrecedeVerticesAndLackTextureCoordinates) {
  const Mesh read = read_as(
      "a.ply",
      "ply\r\nformat ascii 1.0\r\nelement face 3\r\nproperty list uchar int vertex_indices\r\nproperty list "
      "uchar float texcoord\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float "
      "z\r\nend_header\r\n3 0 1 2 0\r\n2 0 1 4 0 0 0 0\r\n3 0 2 3 6 0 0 1 0 1 1\r\n0 0 0\r\n2 0 0\r\n2 1 "
      "0\r\n0 1 0");
  EXPECT_EQ(read.positions, kQuad);
  EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(read.corner_uvs.empty());
}

TEST(Ply, TriangleStrips) {
  const Mesh read = read_as(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 1 4 3\n");
  EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}, {1, 4, 3}}));
}

TEST(Gltf, BinaryAndJsonWithBuffersInsideAndOutside) {
  const Mesh mesh = torus(8, 4);
  const std::string nodes = R"([{"mesh":0}])", buffer = gltf_buffer(mesh);
  write_file("my buffer.bin", buffer);
  for (const auto& [name, contents] :
       {std::pair{"a.glb", glb(mesh)},
        {"a.gltf", gltf_json(mesh, nodes, R"(,"uri":"my%20buffer.bin")")},
        {"b.gltf", gltf_json(mesh, nodes,
                             R"(,"uri":"data:application/octet-stream;base64,)" + base64(buffer) + '"')}}) {
    const Mesh read = read_as(name, contents);
    expect_same_shape(read, mesh);
    EXPECT_EQ(read.corner_uvs, mesh.corner_uvs);
  }
}

TEST(Gltf, NodeTransformsAreAppliedAndMeshesMerged) {
  const Mesh mesh = torus(8, 4);
  // Rotated by 90° about z and doubled, within a translated parent; and a mirror image.
  const std::string nodes =
      R"([{"children":[1,2],"translation":[10,0,0]},{"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476],)"
      R"("scale":[2,2,2]},{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])";
  const Mesh read = read_as("a.glb", glb(gltf_json(mesh, nodes, ""), gltf_buffer(mesh)));
  const auto original = corner_positions(mesh), merged = corner_positions(read);
  ASSERT_EQ(merged.size(), 2 * original.size());
  for (std::size_t c = 0; c < original.size(); ++c) {
    const Vec3& p = original[c];
    const Vec3 turned{10 - 2 * p[1], 2 * p[0], 2 * p[2]}, mirrored{10 - p[0], p[1], p[2] + 5};
    // The mirror image has the opposite orientation.
    const std::size_t m = original.size() + c / 3 * 3 + std::array{0, 2, 1}[c % 3];
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(merged[c][k], turned[k], 1e-14);
      EXPECT_NEAR(merged[m][k], mirrored[k], 1e-14);
    }
  }
}

TEST(Gltf, StripsFansAndSmallIndices) {
  std::string buffer;
  for (const Vec3& p : kQuad)
    for (const double x : p) put(buffer, static_cast<float>(x));
  buffer += std::string("\0\1\3\2", 4);
  const auto read = [&](const std::string& primitive) {
    return read_as(
               "a.glb",
               glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[)" +
                       primitive +
                       R"(,{"mode":1,"attributes":{"POSITION":0}},{"mode":0,"attributes":{"POSITION":0}}]}],)"
                       R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},)"
                       R"({"bufferView":0,"byteOffset":48,"componentType":5121,"type":"SCALAR","count":4}],)"
                       R"("bufferViews":[{"buffer":0,"byteLength":52}],"buffers":[{"byteLength":52}]})",
                   buffer))
        .triangles;
  };
  EXPECT_EQ(read(R"({"mode":5,"attributes":{"POSITION":0},"indices":1})"),
            (std::vector<Triangle>{{0, 1, 3}, {3, 1, 2}}));
  EXPECT_EQ(read(R"({"mode":6,"attributes":{"POSITION":0}})"), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(read(R"({"attributes":{"POSITION":0}})"), (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(Gltf, QuantizedPositions) {
  std::string buffer;
  for (const int x : {-32768, 0, 0, 32767, 0, 0, 0, 32767, 0}) put(buffer, static_cast<std::int16_t>(x));
  const Mesh read = read_as(
      "a.glb",
      glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
          R"("accessors":[{"bufferView":0,"componentType":5122,"normalized":true,"type":"VEC3","count":3}],)"
          R"("bufferViews":[{"buffer":0,"byteLength":18}],"buffers":[{"byteLength":18}]})",
          buffer));
  EXPECT_EQ(read.positions, (std::vector<Vec3>{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(Tds, MeshesAreWeldedWithTextureCoordinates) {
  const Mesh mesh = torus(8, 4), read = read_as("a.3ds", tds(mesh));
  expect_same_shape(read, mesh);
  EXPECT_EQ(read.corner_uvs, mesh.corner_uvs);
}

TEST(Format, IsDetectedByContentFirst) {
  const Mesh mesh = torus(6, 5);
  for (const std::string& contents : {obj(mesh), off(mesh), stl_text(mesh), stl_binary(mesh), ply_text(mesh),
                                      ply_binary(mesh, std::endian::little), glb(mesh), tds(mesh)})
    for (const char* name : {"a.obj", "a.off", "a.stl", "a.PLY", "a.glb", "a.3ds", "a.dat", "a"})
      expect_same_shape(read_as(name, contents), mesh);
}

TEST(Format, AByteOrderMarkOfUtf8IsSkipped) {
  const Mesh mesh = torus(6, 5);
  for (const std::string& contents :
       {obj(mesh), off(mesh), stl_text(mesh), ply_text(mesh), ply_binary(mesh, std::endian::little)})
    for (const char* name : {"a.obj", "a.off", "a"})
      expect_same_shape(read_as(name, "\xEF\xBB\xBF" + contents), mesh);
}

TEST(Format, IsDetectedByExtensionIfContentIsAmbiguous) {
  EXPECT_EQ(read_as("a.OFF", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").triangles.size(), 1u);
  EXPECT_EQ(read_as("a.Obj", "maplib x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").triangles.size(), 1u);
}

TEST(Vertices, UnusedAreDroppedAndEqualAreWelded) {
  const Mesh read =
      read_as("a.obj", "v 9 9 9\nv 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 1 0\nf 2 4 5\nf 6 5 7\n");
  EXPECT_EQ(read.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

}  // namespace
}  // namespace sdm

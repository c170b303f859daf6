#include "io_read/writers.h"

#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <cstdio>
#include <fstream>

#include "support/temporary_folder.h"

namespace sdm::test {

namespace {

// In memory if possible, because the tests write many files.
std::filesystem::path fast_folder() {
  return std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
}

}  // namespace

std::filesystem::path write_file(const std::string& name, std::string_view contents) {
  static const TemporaryFolder folder(fast_folder());
  std::ofstream(folder / name, std::ios::binary) << contents;
  return folder / name;
}

Mesh read_as(const std::string& name, std::string_view contents) {
  return read_mesh(write_file(name, contents));
}

std::string fault_of(const std::string& name, std::string_view contents) {
  const std::filesystem::path file = write_file(name, contents);
  try {
    static_cast<void>(read_mesh(file));
    return "";
  } catch (const Error& fault) {
    const std::string message = fault.what(), prefix = file.string() + ": ";
    EXPECT_EQ(message.substr(0, prefix.size()), prefix);
    return message.substr(std::min(prefix.size(), message.size()));
  }
}

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

namespace {

std::string line(const Vec3& p) {
  return text(p[0]) + ' ' + text(p[1]) + ' ' + text(p[2]) + '\n';
}

void put_vec3f(std::string& out, const Vec3& p) {
  for (const double x : p) put(out, static_cast<float>(x));
}

std::string chunk(std::uint16_t kind, const std::string& data) {
  std::string out;
  put(out, kind);
  put(out, static_cast<std::uint32_t>(data.size() + 6));
  return out + data;
}

}  // namespace

std::string obj(const Mesh& mesh) {
  std::string out;
  for (const Vec3& p : mesh.positions) out += "v " + line(p);
  for (const auto& uvs : mesh.corner_uvs)
    for (const Vec2& uv : uvs) out += "vt " + text(uv[0]) + ' ' + text(uv[1]) + '\n';
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    out += 'f';
    for (std::size_t k = 0; k < 3; ++k) {
      out += ' ' + std::to_string(mesh.triangles[f][k] + 1);
      if (!mesh.corner_uvs.empty()) out += '/' + std::to_string(3 * f + k + 1);
    }
    out += '\n';
  }
  return out;
}

std::string off(const Mesh& mesh) {
  std::string out =
      "OFF\n" + std::to_string(mesh.positions.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Vec3& p : mesh.positions) out += line(p);
  for (const Triangle& t : mesh.triangles)
    out += "3 " + std::to_string(t[0]) + ' ' + std::to_string(t[1]) + ' ' + std::to_string(t[2]) + '\n';
  return out;
}

std::string stl_text(const Mesh& mesh) {
  std::string out = "solid torus\n";
  for (const Triangle& t : mesh.triangles) {
    out += "  facet normal 0 0 0\n    outer loop\n";
    for (const std::uint32_t v : t) out += "      vertex " + line(mesh.positions[v]);
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid torus\n";
}

std::string stl_binary(const Mesh& mesh) {
  std::string out = "solid but binary";
  out.resize(80, '\0');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    put_vec3f(out, {});
    for (const std::uint32_t v : t) put_vec3f(out, mesh.positions[v]);
    put(out, std::uint16_t{0xFFFF});
  }
  return out;
}

namespace {

std::string ply_header(const Mesh& mesh, const char* encoding) {
  return "ply\nformat " + std::string(encoding) + " 1.0\ncomment made by a test\nelement vertex " +
         std::to_string(mesh.positions.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\n" +
         (mesh.corner_uvs.empty() ? "" : "property list uchar float texcoord\n") + "end_header\n";
}

}  // namespace

std::string ply_text(const Mesh& mesh) {
  std::string out = ply_header(mesh, "ascii");
  for (const Vec3& p : mesh.positions) out += line(p);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    out += '3';
    for (const std::uint32_t v : mesh.triangles[f]) out += ' ' + std::to_string(v);
    if (!mesh.corner_uvs.empty()) {
      out += " 6";
      for (const Vec2& uv : mesh.corner_uvs[f]) out += ' ' + text(uv[0]) + ' ' + text(uv[1]);
    }
    out += '\n';
  }
  return out;
}

std::string ply_binary(const Mesh& mesh, std::endian order) {
  std::string out =
      ply_header(mesh, order == std::endian::little ? "binary_little_endian" : "binary_big_endian");
  for (const Vec3& p : mesh.positions)
    for (const double x : p) put(out, x, order);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    put(out, std::uint8_t{3});
    for (const std::uint32_t v : mesh.triangles[f]) put(out, v, order);
    if (mesh.corner_uvs.empty()) continue;
    put(out, std::uint8_t{6});
    for (const Vec2& uv : mesh.corner_uvs[f])
      for (const double x : uv) put(out, static_cast<float>(x), order);
  }
  return out;
}

std::string tds(const Mesh& mesh) {
  std::string vertices, faces, uvs;
  const auto corners = static_cast<std::uint16_t>(3 * mesh.triangles.size());
  put(vertices, corners);
  put(uvs, corners);
  put(faces, static_cast<std::uint16_t>(mesh.triangles.size()));
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      put_vec3f(vertices, mesh.positions[mesh.triangles[f][k]]);
      put(faces, static_cast<std::uint16_t>(3 * f + k));
      if (mesh.corner_uvs.empty()) continue;
      for (const double x : mesh.corner_uvs[f][k]) put(uvs, static_cast<float>(x));
    }
    put(faces, std::uint16_t{7});
  }
  std::string parts = chunk(0x4110, vertices) + chunk(0x4120, faces);
  if (!mesh.corner_uvs.empty()) parts += chunk(0x4140, uvs);
  const std::string object = chunk(0x4000, std::string("torus\0", 6) + chunk(0x4100, parts));
  return chunk(0x4D4D, chunk(0x0002, std::string(4, '\3')) + chunk(0x3D3D, object));
}

std::string gltf_buffer(const Mesh& mesh) {
  std::string positions, uvs, indices;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      put_vec3f(positions, mesh.positions[mesh.triangles[f][k]]);
      put(indices, static_cast<std::uint32_t>(3 * f + k));
      const Vec2 uv = mesh.corner_uvs.empty() ? Vec2{} : mesh.corner_uvs[f][k];
      put(uvs, static_cast<float>(uv[0]));
      put(uvs, static_cast<float>(1 - uv[1]));
    }
  return positions + uvs + indices;
}

std::string gltf_json(const Mesh& mesh, const std::string& nodes, const std::string& buffer_uri) {
  const std::string n = std::to_string(3 * mesh.triangles.size());
  const auto bytes = [&](std::size_t per_corner) {
    return std::to_string(per_corner * 3 * mesh.triangles.size());
  };
  Box box;
  for (const Vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) {
      box.lower[k] = std::min(box.lower[k], p[k]);
      box.upper[k] = std::max(box.upper[k], p[k]);
    }
  const auto list = [](const Vec3& p) {
    return '[' + text(p[0]) + ',' + text(p[1]) + ',' + text(p[2]) + ']';
  };
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}]}],"accessors":[)" +
         R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + n + R"(,"min":)" +
         list(box.lower) + R"(,"max":)" + list(box.upper) +
         R"(},{"bufferView":1,"componentType":5126,"type":"VEC2","count":)" + n +
         R"(},{"bufferView":2,"componentType":5125,"type":"SCALAR","count":)" + n +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + bytes(12) + R"(},{"buffer":0,"byteOffset":)" +
         bytes(12) + R"(,"byteLength":)" + bytes(8) + R"(},{"buffer":0,"byteOffset":)" + bytes(20) +
         R"(,"byteLength":)" + bytes(4) + R"(}],"buffers":[{"byteLength":)" + bytes(24) + buffer_uri + "}]}";
}

std::string glb(std::string json, std::string buffer) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  put(out, static_cast<std::uint32_t>(buffer.size()));
  return out + std::string("BIN\0", 4) + buffer;
}

std::string glb(const Mesh& mesh) {
  return glb(gltf_json(mesh, R"([{"mesh":0}])", ""), gltf_buffer(mesh));
}

std::string base64(std::string_view bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

std::vector<Vec3> corner_positions(const Mesh& mesh) {
  std::vector<Vec3> corners;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) corners.push_back(mesh.positions[v]);
  return corners;
}

}  // namespace sdm::test

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "geometry/vec.h"
#include "io/file/atomic_file.h"
#include "io/file/little_endian.h"
#include "io/mesh/model/glb_model.h"

namespace sdm {

using namespace io;

namespace {

/// The different pairs of texture coordinates, in the order of their first corners.
struct UvRows {
  std::vector<Vec2> uvs;
  std::vector<Triangle> of;  ///< of each triangle
};

UvRows uv_rows(const Mesh& mesh) {
  UvRows rows;
  std::map<Vec2, std::uint32_t> number;
  rows.of.reserve(mesh.corner_uvs.size());
  for (const auto& corners : mesh.corner_uvs) {
    Triangle& t = rows.of.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto [at, is_new] = number.try_emplace(corners[k], static_cast<std::uint32_t>(rows.uvs.size()));
      if (is_new) rows.uvs.push_back(corners[k]);
      t[k] = at->second;
    }
  }
  return rows;
}

// All digits that the numbers have, so that they are read as they were.
void write_obj(std::ostream& out, const Mesh& mesh) {
  const UvRows rows = uv_rows(mesh);
  fmt::memory_buffer text;
  const auto flush = [&](std::size_t above) {
    if (text.size() <= above) return;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  };
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  const auto at = std::back_inserter(text);
  for (const Vec3& p : mesh.positions) {
    fmt::format_to(at, "v {} {} {}\n", p[0], p[1], p[2]);
    flush(kBlock);
  }
  for (const Vec2& uv : rows.uvs) {
    fmt::format_to(at, "vt {} {}\n", uv[0], uv[1]);
    flush(kBlock);
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    fmt::format_to(at, "f");
    for (int k = 0; k < 3; ++k) {
      fmt::format_to(at, " {}", std::size_t{1} + mesh.triangles[f][k]);
      if (!rows.of.empty()) fmt::format_to(at, "/{}", std::size_t{1} + rows.of[f][k]);
    }
    fmt::format_to(at, "\n");
    flush(kBlock);
  }
  flush(0);
}

Vec3f single(const Vec3& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

void write_stl(std::ostream& out, const Mesh& mesh) {
  std::string bytes(80, ' ');
  append_little_endian(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    for (const Vec3& p : {normalized(cross(b - a, c - a)), a, b, c})
      for (const float x : single(p)) append_little_endian(bytes, x);
    bytes.append(2, '\0');
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// A vertex of glTF has one index for all that it has.
struct GltfVertices {
  std::vector<std::pair<std::uint32_t, Vec2>> vertices;  ///< vertices of the mesh, and texture coordinates
  std::vector<Triangle> triangles;
};

GltfVertices gltf_vertices(const Mesh& mesh) {
  GltfVertices result;
  std::map<std::pair<std::uint32_t, Vec2>, std::uint32_t> number;
  result.triangles.reserve(mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    Triangle& t = result.triangles.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const std::pair<std::uint32_t, Vec2> vertex{mesh.triangles[f][k],
                                                  mesh.corner_uvs.empty() ? Vec2{} : mesh.corner_uvs[f][k]};
      const auto [at, is_new] =
          number.try_emplace(vertex, static_cast<std::uint32_t>(result.vertices.size()));
      if (is_new) result.vertices.push_back(vertex);
      t[k] = at->second;
    }
  }
  return result;
}

void write_model(std::ostream& out, const Mesh& mesh) {
  const auto [vertices, triangles] = gltf_vertices(mesh);
  GlbModel glb;
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.indices = glb.add_accessor<Triangle>(
      triangles.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
      TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i, Triangle& t) { t = triangles[i]; });
  const int positions = primitive.attributes["POSITION"] = glb.add_accessor<Vec3f>(
      vertices.size(), TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER,
      [&](std::size_t i, Vec3f& p) { p = single(mesh.positions[vertices[i].first]); });
  Vec3f lo, hi;
  lo.fill(std::numeric_limits<float>::infinity());
  hi.fill(-std::numeric_limits<float>::infinity());
  for (const auto& vertex : vertices) {
    const Vec3f p = single(mesh.positions[vertex.first]);
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  }
  glb.model.accessors[static_cast<std::size_t>(positions)].minValues.assign(lo.begin(), lo.end());
  glb.model.accessors[static_cast<std::size_t>(positions)].maxValues.assign(hi.begin(), hi.end());
  if (!mesh.corner_uvs.empty())  // v points down
    primitive.attributes["TEXCOORD_0"] = glb.add_accessor<std::array<float, 2>>(
        vertices.size(), TINYGLTF_TYPE_VEC2, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER,
        [&](std::size_t i, std::array<float, 2>& uv) {
          uv = {static_cast<float>(vertices[i].second[0]), static_cast<float>(1 - vertices[i].second[1])};
        });
  tinygltf::Mesh of_model;
  of_model.primitives.push_back(primitive);
  glb.model.meshes.push_back(of_model);
  tinygltf::Node node;
  node.mesh = 0;
  glb.add_scene({node});
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&glb.model, out, false, true))
    throw Error("the glTF model could not be written");
}

using Writer = void (*)(std::ostream& out, const Mesh& mesh);
struct WrittenFormat {
  const char* extension;
  Writer write;  ///< null: write_ply()
  bool single_precision;
};
constexpr WrittenFormat kFormats[] = {{".ply", nullptr, false},
                                      {".obj", write_obj, false},
                                      {".stl", write_stl, true},
                                      {".glb", write_model, true}};

const WrittenFormat& written_format(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const WrittenFormat& format : kFormats)
    if (extension == format.extension) return format;
  throw Error(file.string() + ": the extension of a mesh to write must be .ply, .obj, .stl or .glb");
}

}  // namespace

bool is_written_in_single_precision(const std::filesystem::path& file) {
  return written_format(file).single_precision;
}

void write_mesh(const std::filesystem::path& file, const Mesh& mesh) try {
  const WrittenFormat& format = written_format(file);
  if (format.write == nullptr) return write_ply(file, mesh);
  AtomicFile out(file);
  format.write(out.stream(), mesh);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm

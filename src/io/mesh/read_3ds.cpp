#include <fmt/format.h>
#include <sdm/error.h>

#include <vector>

#include "io/file/byte_scanner.h"
#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

// A file is a tree of chunks. Each has a type, a length that includes this six-byte header, data, and
// subchunks.
enum ChunkKind : std::uint16_t {
  kMain = 0x4D4D,
  kEditor = 0x3D3D,
  kObject = 0x4000,
  kTriangleMesh = 0x4100,
  kVertices = 0x4110,
  kFaces = 0x4120,
  kTextureCoordinates = 0x4140,
};
constexpr std::size_t kChunkHeaderBytes = 6;

struct Chunk {
  std::uint16_t kind;
  ByteScanner data;
};

Chunk next_chunk(ByteScanner& in) {
  const auto kind = in.number<std::uint16_t>();
  const auto length = in.number<std::uint32_t>();
  if (length < kChunkHeaderBytes || length - kChunkHeaderBytes > in.remaining())
    throw Error(fmt::format("a chunk of {} bytes does not fit; the file is truncated or damaged", length));
  return {kind, ByteScanner(in.take(length - kChunkHeaderBytes))};
}

void read_triangle_mesh(ByteScanner in, PolygonMesh& mesh) {
  const std::size_t first_vertex = mesh.positions.size(), first_corner = mesh.corners.size();
  std::vector<Vec2> uvs;
  while (in.remaining() > 0) {
    Chunk chunk = next_chunk(in);
    if (chunk.kind == kVertices) {
      for (int count = chunk.data.number<std::uint16_t>(); count > 0; --count) {
        const float x = chunk.data.number<float>(), y = chunk.data.number<float>(),
                    z = chunk.data.number<float>();
        mesh.positions.push_back({x, y, z});
      }
    } else if (chunk.kind == kTextureCoordinates) {
      for (int count = chunk.data.number<std::uint16_t>(); count > 0; --count) {
        const float u = chunk.data.number<float>(), v = chunk.data.number<float>();
        uvs.push_back({u, v});
      }
    } else if (chunk.kind == kFaces) {
      for (int count = chunk.data.number<std::uint16_t>(); count > 0; --count) {
        for (int k = 0; k < 3; ++k)
          mesh.corners.push_back(
              static_cast<std::uint32_t>(first_vertex + chunk.data.number<std::uint16_t>()));
        chunk.data.take(2);  // flags
        mesh.end_polygon();
      }
    }
  }
  const std::size_t vertices = mesh.positions.size() - first_vertex;
  for (std::size_t c = first_corner; c < mesh.corners.size(); ++c)
    if (mesh.corners[c] - first_vertex >= vertices)
      throw Error(fmt::format("index out of range: a face refers to vertex {} of {}",
                              mesh.corners[c] - first_vertex, vertices));
  // Texture coordinates are used if every vertex has them.
  if (uvs.size() == vertices) {
    for (std::size_t c = first_corner; c < mesh.corners.size(); ++c)
      mesh.corner_uvs.push_back(static_cast<std::uint32_t>(mesh.uvs.size() + mesh.corners[c] - first_vertex));
    mesh.uvs.insert(mesh.uvs.end(), uvs.begin(), uvs.end());
  } else {
    mesh.corner_uvs.resize(mesh.corners.size(), kNone);
  }
}

void read_object(ByteScanner in, PolygonMesh& mesh) {
  std::string name;
  for (char c; (c = in.number<char>()) != '\0';) name.push_back(c);
  mesh.objects.begin(mesh.ends.size(), name);
  while (in.remaining() > 0) {
    const Chunk chunk = next_chunk(in);
    if (chunk.kind == kTriangleMesh) read_triangle_mesh(chunk.data, mesh);
  }
}

}  // namespace

PolygonMesh read_3ds(std::string_view bytes) {
  ByteScanner in(bytes);
  Chunk main = next_chunk(in);
  if (main.kind != kMain) throw Error("a 3DS file must begin with a main chunk");
  PolygonMesh mesh;
  while (main.data.remaining() > 0) {
    Chunk chunk = next_chunk(main.data);
    if (chunk.kind != kEditor) continue;
    while (chunk.data.remaining() > 0) {
      const Chunk part = next_chunk(chunk.data);
      if (part.kind == kObject) read_object(part.data, mesh);
    }
  }
  return mesh;
}

}  // namespace sdm::io

#include "io/mesh/write_ply.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/file/little_endian.h"
#include "io/mesh/split_vertices.h"

namespace sdm::io {
namespace {

// Numbers of 8 bits, of colours in sRGB; alpha is linear.
std::uint8_t byte_of(float linear, std::size_t component) {
  const float value = component < 3 ? in_srgb(linear) : std::clamp(linear, 0.f, 1.f);
  return static_cast<std::uint8_t>(std::lround(255 * value));
}

}  // namespace

void write_ply(std::ostream& out, const Mesh& mesh, const MeshExtras& extras) {
  const MeshAttribute* const normals = find_attribute(extras.attributes, "normal", 3, 3);
  const MeshAttribute* const colors = find_attribute(extras.attributes, "color", 3, 4);
  std::vector<CornerRows> arrays;
  for (const MeshAttribute* const attribute : {normals, colors})
    if (attribute != nullptr) arrays.push_back({attribute->rows.get()});
  const SplitVertices split = split_vertices(mesh, arrays);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << split.vertex.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (normals != nullptr) out << "property float nx\nproperty float ny\nproperty float nz\n";
  if (colors != nullptr) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (colors != nullptr && colors->components == 4) out << "property uchar alpha\n";
  out << "element face " << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\n"
      << (mesh.corner_uvs.empty() ? "" : "property list uchar double texcoord\n") << "end_header\n";
  std::string bytes;
  for (std::size_t i = 0; i < split.vertex.size(); ++i) {
    for (const double x : mesh.positions[split.vertex[i]]) append_little_endian(bytes, x);
    if (normals != nullptr)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t row = split.rows.front()[i];
        append_little_endian(bytes, row == kNone ? 0.f : normals->values[3 * row + k]);
      }
    if (colors != nullptr)
      for (std::size_t k = 0; k < colors->components; ++k) {
        const std::uint32_t row = split.rows.back()[i];
        const float value = row == kNone ? 1 : colors->values[colors->components * row + k];
        bytes.push_back(static_cast<char>(byte_of(value, k)));
      }
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    bytes.push_back(3);
    for (const std::uint32_t v : split.triangles[f]) append_little_endian(bytes, v);
    if (mesh.corner_uvs.empty()) continue;
    bytes.push_back(6);
    for (const Vec2& uv : mesh.corner_uvs[f])
      for (const double x : uv) append_little_endian(bytes, x);
  }
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace sdm::io

// Vertices of formats in which a vertex has one value of each kind.
#pragma once

#include <sdm/mesh_attributes.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace sdm::io {

/// An array that corners of faces refer to.
struct CornerRows {
  const std::vector<Triangle>* rows;  ///< kNone: no value
};

/// The vertices of a mesh, one for each combination of rows that corners have.
struct SplitVertices {
  std::vector<std::uint32_t> vertex;             ///< of the mesh
  std::vector<std::vector<std::uint32_t>> rows;  ///< of each array, the row of each vertex
  std::vector<Triangle> triangles;
};

/// Vertices come in the order of the vertices of the mesh, those that no face uses too.
/// Cost: linear.
[[nodiscard]] SplitVertices split_vertices(const Mesh& mesh, std::span<const CornerRows> arrays);

/// The different pairs of texture coordinates, in the order of their first corners.
struct UvRows {
  std::vector<Vec2> uvs;
  std::vector<Triangle> of;  ///< of each triangle
};
[[nodiscard]] UvRows uv_rows(const Mesh& mesh);

/// The attribute of this name with that many components, or null.
[[nodiscard]] const MeshAttribute* find_attribute(std::span<const MeshAttribute> attributes,
                                                  std::string_view name, std::size_t least, std::size_t most);

/// "png", "jpg" or "webp", by the first bytes; "bin" for others.
[[nodiscard]] const char* picture_format(std::span<const char> bytes);

/// A colour component in sRGB of one in linear light, both from 0 to 1: the inverse of linear_light().
[[nodiscard]] inline float in_srgb(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

}  // namespace sdm::io

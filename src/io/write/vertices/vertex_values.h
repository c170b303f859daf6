// The values of the vertices of a file.
#pragma once

#include <sdm/error.h>
#include <sdm/io.h>

#include <cmath>
#include <limits>
#include <span>

namespace sdm::io {

class VertexValues {
 public:
  /// Both must outlive this. Throws sdm::Error if the distances belong to another mesh; `file` is for the
  /// message.
  VertexValues(const std::filesystem::path& file, const FileVertices& vertices,
               std::span<const float> distances)
      : vertices_(vertices.mesh_vertex), distances_(distances) {
    bool fits = vertices.mesh_vertex.size() == vertices.positions.size();
    for (const std::uint32_t v : vertices_) fits = fits && (v == kNone || v < distances.size());
    if (!fits)
      throw Error("cannot write " + file.string() + ": the distances of the vertices belong to another mesh");
  }

  /// NaN if there is none.
  [[nodiscard]] float operator[](std::size_t vertex) const {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    const std::uint32_t v = vertices_[vertex];
    return v != kNone && std::isfinite(distances_[v]) ? distances_[v] : kNaN;
  }

 private:
  std::span<const std::uint32_t> vertices_;
  std::span<const float> distances_;
};

}  // namespace sdm::io

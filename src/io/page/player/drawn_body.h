// A body as a player draws it.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

/// The triangles of a body, each cut into parts² triangles of vertices of their own if there are few.
class DrawnBody {
 public:
  explicit DrawnBody(const Mesh& mesh);

  /// Whether a mesh has the triangles of the body.
  [[nodiscard]] bool fits(const Mesh& mesh) const;
  /// The triangles drawn, with positions from those of the body's vertices.
  [[nodiscard]] Mesh mesh(std::span<const Vec3> positions) const;
  [[nodiscard]] std::span<const Triangle> triangles() const { return drawn_; }
  [[nodiscard]] std::size_t vertices() const { return vertices_; }

 private:
  std::vector<Triangle> of_body_, drawn_;  // without removed faces; of its vertices, and of those drawn
  std::vector<std::uint32_t> used_;        // parts 1: the vertex of the body of each vertex drawn
  std::size_t vertices_ = 0;
  std::uint32_t parts_ = 1;
};

}  // namespace sdm::io

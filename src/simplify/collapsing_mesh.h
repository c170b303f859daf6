// A triangle mesh whose edges are collapsed.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/triangle.h"

namespace sdm::simplify {

/// What a collapse makes of a face.
struct MovedFace {
  std::uint32_t face;
  Triangle triangle;
  Corners corners;
};

/// Faces, and the faces of each vertex. A collapse of the edge from u to v moves u, and gives it the faces of
/// v; vertices and faces keep their numbers.
class CollapsingMesh {
 public:
  /// No face repeats a vertex. Cost: linear.
  explicit CollapsingMesh(const Mesh& mesh);

  [[nodiscard]] const Vec3& position(std::uint32_t v) const { return positions_[v]; }
  [[nodiscard]] std::span<const std::uint32_t> faces_of(std::uint32_t v) const { return faces_of_[v]; }
  [[nodiscard]] const Triangle& triangle(std::uint32_t face) const { return triangles_[face]; }
  [[nodiscard]] Corners corners(std::uint32_t face) const { return corners_of(positions_, triangles_[face]); }
  [[nodiscard]] bool is_left(std::uint32_t face) const { return triangles_[face][0] != kNone; }
  /// How many vertices had faces that were no fan at first: these are never moved.
  [[nodiscard]] std::size_t fixed_vertices() const;
  /// How many faces are left.
  [[nodiscard]] std::size_t size() const { return left_; }

  /// The vertices of faces of v, other than v, in no particular order. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::uint32_t v);
  /// Whether the surface remains what it is, with its borders, if the edge is collapsed: the link condition
  /// (Dey, Edelsbrunner, Guha and Nekhayev 1999).
  [[nodiscard]] bool keeps_topology(std::uint32_t u, std::uint32_t v);
  /// The faces of u and v that are left if both move to a position. Returns false if one of them turns by
  /// more than a right angle, or almost, or loses its area.
  [[nodiscard]] bool move(std::uint32_t u, std::uint32_t v, const Vec3& to,
                          std::vector<MovedFace>& moved) const;
  void collapse(std::uint32_t u, std::uint32_t v, const Vec3& to);
  /// The faces that are left, with the vertices that they have, in their order.
  [[nodiscard]] Mesh mesh() const;

 private:
  void count_neighbours(std::uint32_t v);
  [[nodiscard]] bool is_fan(std::uint32_t v);

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;  // kNone: gone
  std::vector<std::vector<std::uint32_t>> faces_of_;
  std::vector<bool> fixed_;
  std::size_t left_;
  // Memory of count_neighbours(): the neighbours, and how many faces each of them shares; 0 for all others.
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::uint8_t> shared_;
};

}  // namespace sdm::simplify

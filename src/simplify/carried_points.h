// Points of the input that the faces of a simplified mesh stand for.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "simplify/collapsing_mesh.h"

namespace sdm::simplify {

/// The vertices of the input, and points between them where faces are large, each with the face that carries
/// it: one of the mesh on the way that is near it.
class CarriedPoints {
 public:
  /// Each face of the input carries points of its own. Cost: linear.
  CarriedPoints(std::span<const Vec3> positions, std::span<const Triangle> triangles);

  /// The largest distance of the points of faces around an edge to the nearest of the faces that are to
  /// replace these; larger ones than `enough` may be met by one of them only. Remembers what was found.
  [[nodiscard]] double measure(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v,
                               std::span<const MovedFace> moved, double enough);
  /// Gives the points of all these faces to what was found: no distance was larger than `enough`.
  void carry(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v, std::span<const MovedFace> moved);

 private:
  void add(const Vec3& p, std::uint32_t face);
  void add_between(const Corners& corners, const Triangle& t, std::uint32_t face, double spacing);

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> next_;                             // of the same face
  std::vector<std::uint32_t> first_;                            // of each face
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found_;  // points, and the moved face nearest to each
};

}  // namespace sdm::simplify

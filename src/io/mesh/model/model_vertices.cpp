#include "io/mesh/model/model_vertices.h"

#include <cmath>
#include <utility>

namespace sdm::io {
namespace {

// Positions closer than this, in texels, are equal: charts are farther apart, and rounding errors are far
// smaller.
constexpr double kSamePlace = 1.0 / 64;
// The most positions searched for each normal: a vertex of a million single-face charts must not take 10^12
// steps.
constexpr int kMostSplits = 64;

bool same(const Vec2& a, const Vec2& b) {
  return std::abs(a[0] - b[0]) <= kSamePlace && std::abs(a[1] - b[1]) <= kSamePlace;
}

}  // namespace

std::vector<std::uint32_t> drawn_faces(const Mesh& mesh) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    if (const auto& [a, b, c] = mesh.triangles[face]; a != b && b != c && c != a) faces.push_back(face);
  return faces;
}

ModelVertices model_vertices(const Surface& surface, const ShadingNormals& normals,
                             std::span<const std::uint32_t> faces, const MeshAttribute* tangents) {
  const auto charts = surface.face_charts();
  ModelVertices result;
  // The vertices of each normal are a linked list: first[normal], next[vertex], ...
  std::vector<std::uint32_t> first(normals.normals.size(), kNone), next;
  result.triangles.reserve(faces.size());
  for (const std::uint32_t face : faces) {
    Triangle& triangle = result.triangles.emplace_back();
    // A face with almost no area is invisible: any position will do.
    const auto corners = charts[face] == kNone ? std::array<Vec2, 3>{} : surface.atlas_corners(face);
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t normal = normals.corner[face][corner];
      const Vec2& place = corners[corner];
      const std::uint32_t tangent = tangents == nullptr ? kNone : (*tangents->rows)[face][corner];
      const auto fits = [&](std::uint32_t vertex) {
        return same(result.place[vertex], place) &&
               (tangents == nullptr || result.tangent[vertex] == tangent);
      };
      std::uint32_t vertex = first[normal];
      for (int looked_at = 0; vertex != kNone; vertex = next[vertex])
        if (fits(vertex) || ++looked_at == kMostSplits) break;
      if (vertex == kNone || !fits(vertex)) {
        vertex = static_cast<std::uint32_t>(result.place.size());
        result.place.push_back(place);
        if (tangents != nullptr) result.tangent.push_back(tangent);
        result.normal.push_back(normal);
        next.push_back(std::exchange(first[normal], vertex));
      }
      triangle[corner] = vertex;
    }
  }
  return result;
}

}  // namespace sdm::io

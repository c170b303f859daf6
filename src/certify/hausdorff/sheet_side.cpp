#include "certify/hausdorff/sheet_side.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "tree/visit.h"

namespace sdm::hausdorff {

SheetSide::SheetSide(const sites::SitesData& sheet, bool behind, double precision)
    : sheet_(sheet),
      boundary_(inside::signs_of(sheet).boundary()),
      towards_(behind ? -1 : 1),
      margin_(precision / 4) {}

SheetSide::Extent SheetSide::extent(const Corners& triangle, const Vec3& direction, const Vec3& from) {
  const auto [least, most] =
      std::minmax({dot(direction, triangle[0] - from), dot(direction, triangle[1] - from),
                   dot(direction, triangle[2] - from)});
  return {least, most};
}

bool SheetSide::is_beyond(const Corners& triangle, const Vec3& normal, const Vec3& at, bool touching) const {
  const double length = norm(normal);
  if (!(length > 0)) return false;
  return extent(triangle, towards_ / length * normal, at).most <= (touching ? margin_ : -margin_);
}

Vec3 SheetSide::inward(std::uint32_t face, int k) const {
  const Corners corners = corners_of(sheet_.mesh, face);
  const Vec3& from = corners[k];
  const Vec3 along = normalized(corners[(k + 1) % 3] - from), other = corners[(k + 2) % 3] - from;
  return normalized(other - dot(other, along) * along);
}

bool SheetSide::by_vertex(const Corners& triangle, std::uint32_t vertex) const {
  const Vec3& at = sheet_.mesh.positions[vertex];
  for (const std::uint32_t face : sheet_.vertex_faces.of(vertex))
    for (const std::uint32_t other : sheet_.mesh.triangles[face]) {
      if (other == vertex) continue;
      // A point is farther from the vertex than from an edge that leads towards it.
      const Vec3 along = normalized(sheet_.mesh.positions[other] - at);
      if (extent(triangle, along, at).least > margin_) return true;
    }
  return boundary_.vertices[vertex] == 0 && is_beyond(triangle, sheet_.normals.vertex[vertex], at, false);
}

// Where the normals of both faces are within 106° of each other, the way from the edge to a point closest to
// it is within 53° of their sum: one that is on the wrong side by no more than the margin is closer than
// twice that.
bool SheetSide::by_edge(const Corners& triangle, std::uint32_t edge) const {
  constexpr double kSharpest = 0.6;  // more than a face without a normal leaves
  const std::span<const std::uint32_t> faces = sheet_.topology.edge_faces(edge);
  const auto& [a, b] = sheet_.topology.edges[edge];
  const Vec3 &from = sheet_.mesh.positions[a], &to = sheet_.mesh.positions[b];
  const Vec3 along = normalized(to - from);
  if (extent(triangle, along, from).most < -margin_ || extent(triangle, along, to).least > margin_)
    return true;
  Vec3 normal{};
  for (const std::uint32_t face : faces) {
    for (int k = 0; k < 3; ++k)  // a point above the face is closer to it
      if (sheet_.topology.face_edges[face][k] == edge &&
          extent(triangle, inward(face, k), from).least > margin_)
        return true;
    normal += sheet_.normals.face[face];
  }
  const bool is_flat = faces.size() == 2 && norm(normal) >= 2 * kSharpest;
  return boundary_.edges[edge] == 0 && is_beyond(triangle, normal, from, is_flat);
}

bool SheetSide::by_face(const Corners& triangle, std::uint32_t face) const {
  const Corners corners = corners_of(sheet_.mesh, face);
  const Vec3& normal = sheet_.normals.face[face];
  bool beside = false;  // so that no point is above the face
  for (int k = 0; k < 3; ++k) beside |= extent(triangle, inward(face, k), corners[k]).most < -margin_;
  if (!beside && !is_beyond(triangle, normal, corners[0], true)) return false;
  for (const std::uint32_t edge : sheet_.topology.face_edges[face])
    if (!by_edge(triangle, edge)) return false;
  return std::ranges::all_of(sheet_.mesh.triangles[face],
                             [&](std::uint32_t vertex) { return by_vertex(triangle, vertex); });
}

bool SheetSide::is_on_other_side(const Corners& triangle, double upper) const {
  constexpr std::size_t kMost = 1024;
  Box box;
  for (const Vec3& corner : triangle) extend(box, sheet_.frame.to_unit(corner));
  const tree::FloatBox around = tree::FloatBox::around(box);
  const double reach = (1 + kDoubleRounding) * upper + margin_;
  std::size_t seen = 0;
  bool all = true;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) {
    return all && distance <= reach * sheet_.frame.scale + 2 * kFewRoundings;
  };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : sheet_.tree.items_of(node)) {
      if (!all || closest_or_common(triangle, corners_of(sheet_.mesh, face)).squared > reach * reach)
        continue;
      all = ++seen <= kMost && by_face(triangle, face);
    }
  };
  tree::visit(sheet_.tree, tree::NearestFirst{bound, enter, leaf});
  return all;
}

}  // namespace sdm::hausdorff

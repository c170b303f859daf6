#include "certify/hausdorff/side.h"

#include <cmath>

#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "inside/sign.h"
#include "inside/solid.h"

namespace sdm::hausdorff {

namespace {

// How far a part may be on the wrong side of a plane that keeps it out of B, in precisions.
constexpr double kSlack = 1.0 / 16;

}  // namespace

bool SolidSide::has(const Vec3& p) const {
  return inside::contains(solid_, p) == inside_;
}

// The way from the point to one on this side leads through B.
double SolidSide::bound(const Corners& triangle, const Known& known) const {
  if (is_one_sided(triangle)) return 0;
  const double slack = kSlack * known.precision;
  if (known.distance > known.precision && only_touches(triangle, slack))
    return std::min(known.upper, 2 * slack);
  return std::clamp((1 + kFewRoundings) * known.radius - known.distance, 0.0, known.upper);
}

bool SolidSide::is_one_sided(const Corners& triangle) const {
  // Mapping corners into the frame rounds.
  Box box;
  for (const Vec3& corner : triangle) {
    Vec3 unit = solid_.frame.to_unit(corner), rounding;
    for (int k = 0; k < 3; ++k) rounding[k] = kFewRoundings * (1 + std::abs(unit[k]));
    extend(box, unit - rounding);
    extend(box, unit + rounding);
  }
  const tree::FloatBox around = tree::FloatBox::around(box);
  bool apart = true;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) { return apart && distance == 0; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : solid_.tree.items_of(node))
      if (apart && triangles_intersect(triangle, corners_of(solid_.mesh, face))) apart = false;
  };
  tree::visit(solid_.tree, tree::NearestFirst{bound, enter, leaf});
  return apart;
}

// Where the triangle T meets the surface of B, all faces there are on one side of the plane and T on the
// other. Close to such a place, what is strictly above the plane meets no face and so is all inside of B or
// all outside; the points of T that are not on B are as these are, as T is connected.
bool SolidSide::only_touches(const Corners& triangle, double slack) const {
  constexpr std::size_t kMost = 64;
  constexpr double kFlattest =
      1.0 / 16;  // height of a face, in sizes of the triangle, for its plane to be exact
  Box box;
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    extend(box, solid_.frame.to_unit(triangle[k]));
    size = std::max(size, norm(triangle[k < 2 ? k + 1 : 0] - triangle[k]));
  }
  const double max_distance = 4 * slack;
  const tree::FloatBox around = tree::FloatBox::around(box);
  std::vector<Corners> faces;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) {
    return faces.size() <= kMost && distance <= max_distance * solid_.frame.scale + 2 * kFewRoundings;
  };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : solid_.tree.items_of(node)) {
      const Corners corners = corners_of(solid_.mesh, face);
      if (closest_or_common(triangle, corners).squared <= max_distance * max_distance)
        faces.push_back(corners);
    }
  };
  tree::visit(solid_.tree, tree::NearestFirst{bound, enter, leaf});
  if (faces.size() > kMost) return false;
  const auto separates = [&](const Corners& plane) {
    const Vec3 normal = cross(plane[1] - plane[0], plane[2] - plane[0]);
    const double area = norm(normal),
                 longest = std::max(
                     {norm(plane[1] - plane[0]), norm(plane[2] - plane[1]), norm(plane[0] - plane[2])});
    if (!(area >= kFlattest * longest * std::min(size, longest))) return false;
    const auto height = [&](const Vec3& p) { return dot(normal, p - plane[0]) / area; };
    double least = kInfinity, most = -least, lowest = least, highest = most;
    for (const Vec3& p : triangle) {
      least = std::min(least, height(p));
      most = std::max(most, height(p));
    }
    for (const Corners& face : faces)
      for (const Vec3& p : face) {
        lowest = std::min(lowest, height(p));
        highest = std::max(highest, height(p));
      }
    return (least >= -slack && highest <= slack) || (most <= slack && lowest >= -slack);
  };
  return separates(triangle) || std::ranges::any_of(faces, separates);
}

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
  const double max_distance = (1 + kDoubleRounding) * upper + margin_;
  std::size_t seen = 0;
  bool all = true;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) {
    return all && distance <= max_distance * sheet_.frame.scale + 2 * kFewRoundings;
  };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : sheet_.tree.items_of(node)) {
      if (!all ||
          closest_or_common(triangle, corners_of(sheet_.mesh, face)).squared > max_distance * max_distance)
        continue;
      all = ++seen <= kMost && by_face(triangle, face);
    }
  };
  tree::visit(sheet_.tree, tree::NearestFirst{bound, enter, leaf});
  return all;
}

}  // namespace sdm::hausdorff

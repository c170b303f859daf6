#include "closest/facing/facing_normals.h"

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "closest/facing/facing_search.h"
#include "core/parallel.h"
#include "geometry/triangle.h"
#include "geometry/vec.h"
#include "mesh/topology.h"
#include "sites/orient_outward.h"
#include "sites/regions.h"
#include "surface/surface_data.h"
#include "tree/aabb_tree.h"

namespace sdm::facing {
namespace {

/// A tree over the faces with edges, which tells shells inside others from those outside of them.
tree::AabbTree tree_of(const Mesh& mesh, const mesh::Topology& topology, const UnitFrame& frame) {
  std::vector<tree::FloatBox> boxes(mesh.triangles.size());
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < boxes.size(); ++f) {
    const Corners corners = corners_of(mesh, f);
    Box box;
    for (const Vec3& corner : corners) extend(box, frame.to_unit(corner));
    boxes[f] = tree::FloatBox::around(box);
    if (!topology.ignored(f)) faces.push_back(f);
  }
  return tree::build_aabb_tree(boxes, faces, sites::FaceBounds::kWidth);
}

/// The faces of which the order of corners is clockwise seen from outside; empty if there is no outside.
Array<std::uint8_t> inward_faces(const Mesh& mesh) {
  const mesh::Topology topology = mesh::build_topology(mesh.positions.size(), mesh.triangles);
  if (!topology.closed()) return {};
  const mesh::Orientation orientation = mesh::orient(mesh.triangles, topology);
  if (!orientation.orientable) return {};
  const sites::Shells shells = sites::find_shells(orientation);
  const UnitFrame frame = UnitFrame::of(bounds(mesh));
  const tree::AabbTree tree = shells.size() > 1 ? tree_of(mesh, topology, frame) : tree::AabbTree{};
  Array<std::uint8_t> inverted;
  sites::orient_outward({mesh.positions, mesh.triangles, frame, tree}, orientation, shells, inverted);
  return inverted;
}

constexpr double kLow = 1e-3;         // of the diagonal
constexpr double kLeastSum = 0.5;     // of the area of the surroundings
constexpr double kLeastAround = 2.0;  // times the area of the face

/// Normals of faces together, weighted by their areas.
struct AreaVector {
  Vec3 sum{};
  double area = 0;

  void add(const AreaVector& other, double times) {
    sum += times * other.sum;
    area += times * other.area;
  }
};

AreaVector area_vector(const Mesh& mesh, std::size_t face, const Vec3& normal) {
  const auto [a, b, c] = corners_of(mesh, face);
  const double area = norm(cross(b - a, c - a)) / 2;
  return {area * normal, area};
}

double least_height(const Mesh& mesh, std::size_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  return norm(cross(b - a, c - a)) / std::max({norm(b - a), norm(c - b), norm(a - c)});
}

FacingNormals with_surroundings(const Mesh& mesh, std::vector<Vec3> normals, double angle) {
  const FacingAngle facing(angle);
  FacingNormals result{.normals = std::move(normals), .height = kLow * diagonal(bounds(mesh))};
  std::vector<std::uint32_t> low;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    if (result.normals[f] != Vec3{} && least_height(mesh, f) < result.height) low.push_back(f);
  if (low.empty()) return result;

  std::vector<AreaVector> at_vertex(mesh.positions.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
    if (result.normals[f] != Vec3{})
      for (const std::uint32_t v : mesh.triangles[f])
        at_vertex[v].add(area_vector(mesh, f, result.normals[f]), 1);
  for (const std::uint32_t f : low) {
    Vec3& normal = result.normals[f];
    const AreaVector own = area_vector(mesh, f, normal);
    AreaVector around;
    for (const std::uint32_t v : mesh.triangles[f]) around.add(at_vertex[v], 1);
    around.add(own, -3);
    const double length = norm(around.sum);
    if (length < kLeastSum * around.area || around.area < 3 * kLeastAround * own.area) continue;
    const Vec3 outward = (1 / length) * around.sum;
    if (facing.allows(dot(outward, normal))) continue;
    normal = outward;
    result.replaced.push_back(f);
  }
  return result;
}

}  // namespace

bool has_outside(const Mesh& mesh) {
  const mesh::Topology topology = mesh::build_topology(mesh.positions.size(), mesh.triangles);
  return topology.closed() && mesh::orient(mesh.triangles, topology).orientable;
}

std::vector<Vec3> outward_normals(const Mesh& mesh) {
  constexpr std::size_t kFaces = 4096;
  const Array<std::uint8_t> inward = inward_faces(mesh);
  std::vector<Vec3> normals(mesh.triangles.size());
  parallel_for(normals.size(), kFaces, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (is_removed(mesh.triangles[f])) continue;
      const auto [a, b, c] = corners_of(mesh, static_cast<std::uint32_t>(f));
      normals[f] = normalized(cross(b - a, c - a));
      if (!inward.empty() && inward[f] != 0) normals[f] = -1.0 * normals[f];
    }
  });
  return normals;
}

const std::vector<Vec3>& outward_normals(const Surface& surface) {
  return internals(surface).outward_normals.get(
      [&] { return std::make_shared<std::vector<Vec3>>(outward_normals(surface.mesh())); });
}

FacingNormals facing_normals(const Mesh& mesh, double angle) {
  return with_surroundings(mesh, outward_normals(mesh), angle);
}

FacingNormals facing_normals(const Surface& surface, double angle) {
  return with_surroundings(surface.mesh(), outward_normals(surface), angle);
}

}  // namespace sdm::facing

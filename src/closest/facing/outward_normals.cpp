#include "closest/facing/outward_normals.h"

#include <sdm/mesh_edit.h>

#include <memory>

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

}  // namespace sdm::facing

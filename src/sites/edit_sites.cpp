#include <algorithm>
#include <utility>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "hierarchy/edit_tree.h"
#include "mesh/edit_topology.h"
#include "sites/sites_data.h"

namespace sdm::sites {
namespace {

// The tree is built anew when more than one in this many of its faces was added since: those in the leaves
// that were best when they were added need not be well placed any more.
constexpr std::size_t kAddedShare = 4;

// Whether boxes in one frame can be compared with those in the other, so that a tree is worth keeping.
bool similar(const UnitFrame& a, const UnitFrame& b) {
  const double ratio = a.scale / b.scale;
  return ratio > 0.4 && ratio < 2.5 && norm(a.to_unit(b.origin)) < 4;
}

std::vector<std::uint32_t> changed_faces(const MeshEdit& edit) {
  std::vector<std::uint32_t> faces = edit.removed_faces;
  for (const auto& reconnected : edit.reconnected_faces) faces.push_back(reconnected.face);
  return faces;
}

}  // namespace

void SitesData::edit(const MeshEdit& edit) {
  Mesh edited = mesh;
  apply(edited, edit);
  const std::vector<std::uint32_t> changed = changed_faces(edit);
  const std::vector<Triangle> before = std::exchange(mesh, std::move(edited)).triangles;
  const bool repaired =
      topology.duplicate_faces == 0 &&
      mesh::edit_topology({before, mesh.triangles, changed, mesh.positions.size()}, topology, vertex_faces);
  if (!repaired) {
    topology = mesh::build_topology(mesh.positions.size(), mesh.triangles);
    vertex_faces = mesh::vertex_faces(mesh.positions.size(), mesh.triangles, topology);
  }
  const UnitFrame frame_before = std::exchange(frame, UnitFrame::of(bounds(mesh)));
  parallel_invoke([&] { find_orientation(); },
                  [&] {
                    if (!repaired || !similar(frame, frame_before) || !edit_tree(frame_before)) build_tree();
                  });

  normals.face.resize(mesh.triangles.size());
  normals.vertex.resize(mesh.positions.size());
  sliver.resize(mesh.triangles.size());
  const auto forget = [&](std::size_t face) {  // what is computed only for faces and vertices that have sites
    normals.face[face] = {};
    sliver[face] = 0;
  };
  for (const std::uint32_t face : changed) {
    forget(face);
    for (const std::uint32_t v : before[face]) normals.vertex[v] = {};
  }
  if (!repaired)
    for (std::size_t face = 0; face < mesh.triangles.size(); ++face)
      if (topology.ignored(face)) forget(face);
  assign_sites(last_refit_);
  find_leaf_boxes(regions, frame, last_refit_.placed, last_refit_.boxes);
  hierarchy::refit_leaves(tree, last_refit_.boxes);
  wide = hierarchy::collapse(tree);
  compute_regions(last_refit_);
}

// False if too many faces would have been added since the tree was built.
bool SitesData::edit_tree(const UnitFrame& frame_before) {
  std::vector<std::uint8_t> in_tree(mesh.triangles.size(), 0), kept(mesh.triangles.size(), 0);
  for (const std::uint32_t face : tree.items) in_tree[face] = 1;
  std::vector<std::uint32_t> added;
  for (std::uint32_t face = 0; face < kept.size(); ++face) {
    kept[face] = in_tree[face] && !topology.ignored(face);
    if (!in_tree[face] && !topology.ignored(face)) added.push_back(face);
  }
  faces_added_to_tree_ += added.size();
  if (kAddedShare * faces_added_to_tree_ > tree.items.size()) return false;
  const auto box_of = [&](std::uint32_t face) {
    Box box;
    for (const std::uint32_t v : mesh.triangles[face]) extend(box, frame_before.to_unit(mesh.positions[v]));
    return hierarchy::FloatBox::around(box);
  };
  tree = hierarchy::edit_tree(tree, {kept, added, box_of}, FaceBounds::kWidth);
  return true;
}

}  // namespace sdm::sites

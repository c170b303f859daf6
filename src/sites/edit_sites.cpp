#include <type_traits>
#include <utility>

#include "core/parallel.h"
#include "geometry/vec.h"
#include "mesh/edit_topology.h"
#include "sites/sites_data.h"
#include "tree/aabb_tree.h"

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

// Nearly everything is built anew, so that the edited sites replace the others only when they are complete.
void SitesData::edit(const MeshEdit& edit) {
  static_assert(std::is_nothrow_move_assignable_v<SitesData>);
  intact_.require();
  *this = SitesData(*this, edit);
}

SitesData::SitesData(SitesData& before, const MeshEdit& edit)
    : mesh(before.mesh), faces_added_to_tree_(before.faces_added_to_tree_) {
  apply(mesh, edit);
  const std::size_t vertices = mesh.positions.size(), faces = mesh.triangles.size();
  const bool repaired =
      before.topology.duplicate_faces == 0 &&
      mesh::edit_topology({before.mesh.triangles, mesh.triangles, changed_faces(edit), vertices},
                          {before.topology, before.vertex_faces}, topology, vertex_faces);
  if (!repaired) {
    topology = mesh::build_topology(vertices, mesh.triangles);
    vertex_faces = mesh::vertex_faces(vertices, mesh.triangles, topology);
  }
  frame = UnitFrame::of(bounds(mesh));
  parallel_invoke([&] { find_orientation(); },
                  [&] {
                    if (!repaired || !similar(frame, before.frame) || !edit_tree(before)) build_tree();
                  });
  normals = {std::vector<Vec3>(faces), std::vector<Vec3>(vertices)};
  sliver.resize(faces);
  last_refit_ = std::move(before.last_refit_);
  assign_sites(last_refit_);
  find_leaf_boxes(regions, frame, last_refit_.placed, last_refit_.boxes);
  tree::refit_leaves(tree, last_refit_.boxes);
  wide = tree::collapse(tree);
  compute_regions(last_refit_);
}

// False if too many faces would have been added since the tree was built, or too many at one place.
bool SitesData::edit_tree(const SitesData& before) {
  std::vector<std::uint8_t> in_tree(mesh.triangles.size(), 0), kept(mesh.triangles.size(), 0);
  for (const std::uint32_t face : before.tree.items) in_tree[face] = 1;
  std::vector<std::uint32_t> added;
  for (std::uint32_t face = 0; face < kept.size(); ++face) {
    kept[face] = in_tree[face] && !topology.ignored(face);
    if (!in_tree[face] && !topology.ignored(face)) added.push_back(face);
  }
  faces_added_to_tree_ += added.size();
  if (kAddedShare * faces_added_to_tree_ > before.tree.items.size()) return false;
  const auto box_of = [&](std::uint32_t face) {
    Box box;
    for (const std::uint32_t v : mesh.triangles[face]) extend(box, before.frame.to_unit(mesh.positions[v]));
    return tree::FloatBox::around(box);
  };
  tree = tree::edit_tree(before.tree, {kept, added, box_of}, FaceBounds::kWidth);
  return tree::depth(tree) <= tree::kDeepest;
}

}  // namespace sdm::sites

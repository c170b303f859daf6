#include "sites/sites_data.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "mesh/check_topology.h"
#include "mesh/validate.h"
#include "sites/check_numbers.h"
#include "sites/check_regions.h"
#include "tree/aabb_tree.h"

namespace sdm::sites {
namespace {

constexpr std::uint32_t kLeafFaces = FaceBounds::kWidth;
constexpr std::size_t kBoxGrain = 4096;

std::vector<std::uint32_t> faces_with_sites(const mesh::Topology& topology) {
  std::vector<std::uint32_t> faces;
  faces.reserve(topology.face_edges.size());
  for (std::size_t f = 0; f < topology.face_edges.size(); ++f)
    if (!topology.ignored(f)) faces.push_back(static_cast<std::uint32_t>(f));
  return faces;
}

}  // namespace

SitesData::SitesData(Mesh given) {
  frame = UnitFrame::of(mesh::validated_bounds(given));
  mesh = std::move(given);
  const std::vector<Triangle>& triangles = mesh.triangles;
  topology = mesh::build_topology(mesh.positions.size(), triangles);
  parallel_invoke(
      [&] {
        vertex_faces = mesh::vertex_faces(mesh.positions.size(), triangles, topology);
        find_orientation();
      },
      [&] {
        build_tree();
        wide = tree::collapse(tree);
      });
  normals = {std::vector<Vec3>(triangles.size()), std::vector<Vec3>(mesh.positions.size())};
  sliver.resize(triangles.size());
  Refit refit;  // discarded: a mesh that is never refitted does not need it
  assign_sites(refit);
  compute_regions(refit);
}

// The frame, the shells and whether the mesh is closed take less time to find than to load and check.
SitesData::SitesData(ArrayReader& stored, bool trusted) {
  stored(*this);
  frame = UnitFrame::of(trusted ? bounds(mesh) : mesh::validated_bounds(mesh));
  if (!trusted && !is_valid()) stored.fail();
  find_shells();
}

bool SitesData::is_valid() const {
  bool valid_topology = false, valid_trees = false;
  parallel_invoke(
      [&] {
        valid_topology =
            mesh::is_topology(topology, vertex_faces, mesh) && mesh::is_orientation(orientation, topology);
      },
      [&] {
        valid_trees =
            !tree.items.empty() && tree::is_tree(tree, kLeafFaces, kUnitReach) && tree::is_tree(wide, tree);
      });
  return valid_topology && valid_trees && sites::match(*this) && mesh::are_flags(inverted);
}

void SitesData::find_orientation() {
  orientation = mesh::orient(mesh.triangles, topology);
  find_shells();
}

void SitesData::find_shells() {
  closed = topology.closed();
  shells = is_solid() ? sites::find_shells(orientation) : Shells{};
  consistently_oriented = is_solid() && std::ranges::count(orientation.flipped, 1) == 0;
}

void SitesData::assign_sites(Refit& refit) {
  regions = build_regions(
      {mesh.positions, mesh.triangles, topology, vertex_faces, orientation.orientable, frame.scale}, tree);
  place(regions, mesh.positions, refit.placed);
}

void SitesData::build_tree() {
  tree = tree::build_aabb_tree(face_boxes(), faces_with_sites(topology), kLeafFaces);
  faces_added_to_tree_ = 0;
}

// Refits in place, since copies would take longer than the rest: what may fail for want of memory comes
// first, as far as it can be foreseen.
void SitesData::refit(std::span<const Vec3> positions) {
  intact_.require();
  mesh::validate_positions(positions, mesh.positions.size());
  Refit& refit = last_refit_;
  place(regions, positions, refit.placed);
  refit.boxes.reserve(regions.bounds.size());
  refit.shapes.reserve(regions.faces.size());
  intact_.change([&] {
    std::ranges::copy(positions, mesh.positions.begin());
    frame = UnitFrame::of(bounds(mesh));
    find_leaf_boxes(regions, frame, refit.placed, refit.boxes);
    tree::refit_leaves(tree, refit.boxes);
    tree::refit(wide, tree);
    frames.forget();
    shape_number = unique_number();
    signs.outdate();
    normal_bounds.forget();
    compute_regions(refit);
  });
}

// The boxes of faces are those of their vertices, each rounded outwards.
std::vector<tree::FloatBox> SitesData::face_boxes() const {
  std::vector<tree::FloatBox> corners(mesh.positions.size()), boxes(mesh.triangles.size());
  parallel_for(corners.size(), kBoxGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 p = frame.to_unit(mesh.positions[v]);
      corners[v] = tree::FloatBox::around({p, p});
    }
  });
  parallel_for(boxes.size(), kBoxGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto [a, b, c] = mesh.triangles[f];
      boxes[f] = unite(unite(corners[a], corners[b]), corners[c]);
    }
  });
  return boxes;
}

void SitesData::set_inverted() {
  if (is_solid())
    orient_outward(face_tree(), orientation, shells, inverted);
  else if (orientation.orientable)
    inverted = orientation.flipped;
  else
    inverted.assign(mesh.triangles.size(), 0);
}

void SitesData::compute_regions(Refit& refit) {
  set_inverted();
  sites::refit(regions, {frame, refit.placed, inverted}, normals, sliver, refit.shapes);
}

}  // namespace sdm::sites

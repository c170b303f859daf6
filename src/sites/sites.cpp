#include <sdm/sites.h>

#include <algorithm>
#include <utility>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec.h"
#include "mesh/validate.h"
#include "sites/orient_outward.h"
#include "sites/sites_data.h"

namespace sdm {
namespace {

constexpr std::uint32_t kLeafFaces = sites::FaceBounds::kWidth;
constexpr std::size_t kGrain = 4096;

// What a triangle soup takes while its sites are built; meshes take half of it.
void require_memory_for(const Mesh& mesh) {
  constexpr std::size_t kBytesPerFace = 900, kBytesPerVertex = 60;
  require_memory(kBytesPerFace * mesh.triangles.size() + kBytesPerVertex * mesh.positions.size(), "O2");
}

std::vector<std::uint32_t> faces_with_sites(const mesh::Topology& topology) {
  std::vector<std::uint32_t> faces;
  faces.reserve(topology.face_edges.size());
  for (std::size_t f = 0; f < topology.face_edges.size(); ++f)
    if (!topology.ignored(f)) faces.push_back(static_cast<std::uint32_t>(f));
  return faces;
}

// The boxes of faces are those of their vertices, each rounded outwards.
std::vector<hierarchy::FloatBox> face_boxes(const sites::SitesData& s) {
  std::vector<hierarchy::FloatBox> corners(s.mesh.positions.size()), boxes(s.mesh.triangles.size());
  parallel_for(corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 p = s.frame.to_unit(s.mesh.positions[v]);
      corners[v] = hierarchy::FloatBox::around({p, p});
    }
  });
  parallel_for(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto [a, b, c] = s.mesh.triangles[f];
      boxes[f] = unite(unite(corners[a], corners[b]), corners[c]);
    }
  });
  return boxes;
}

void set_inverted(sites::SitesData& s) {
  if (s.is_solid())
    sites::orient_outward(s.mesh.positions, s.frame, s.mesh.triangles, s.orientation, s.shells, s.tree,
                          s.inverted);
  else if (s.orientation.orientable)
    s.inverted = s.orientation.turned;
  else
    s.inverted.assign(s.mesh.triangles.size(), 0);
}

}  // namespace

Sites::Sites(Mesh mesh) : data_(std::make_unique<sites::SitesData>()) {
  validate(mesh);
  require_memory_for(mesh);
  sites::SitesData& s = *data_;
  s.mesh = std::move(mesh);
  const auto& triangles = s.mesh.triangles;
  s.frame = UnitFrame::of(bounds(s.mesh));
  s.topology = mesh::build_topology(s.mesh.positions.size(), triangles);
  parallel_invoke(
      [&] {
        s.vertex_faces = mesh::vertex_faces(s.mesh.positions.size(), triangles, s.topology);
        s.orientation = mesh::orient(triangles, s.topology);
        s.closed = s.topology.closed();
        if (s.is_solid()) s.shells = sites::find_shells(s.orientation);
        s.alike = s.is_solid() && std::ranges::count(s.orientation.turned, 1) == 0;
      },
      [&] {
        s.tree = hierarchy::build_aabb_tree(face_boxes(s), faces_with_sites(s.topology), kLeafFaces);
        s.wide = hierarchy::collapse(s.tree);
      });
  s.regions = sites::build_regions(
      {s.mesh.positions, triangles, s.topology, s.vertex_faces, s.orientation.orientable, s.frame.scale},
      s.tree);
  s.normals = {std::vector<Vec3>(triangles.size()), std::vector<Vec3>(s.mesh.positions.size())};
  s.sliver.resize(triangles.size());
  set_inverted(s);
  sites::SitesData::Refit refit;  // nothing is kept for a mesh that is never refitted
  sites::place(s.regions, s.mesh.positions, refit.placed);
  sites::refit(s.regions, s.frame, refit.placed, s.inverted, s.normals, s.sliver, refit.shapes);
}

Sites::~Sites() = default;
Sites::Sites(Sites&&) noexcept = default;
Sites& Sites::operator=(Sites&&) noexcept = default;

void Sites::refit(std::span<const Vec3> positions) {
  sites::SitesData& s = *data_;
  mesh::validate_positions(positions, s.mesh.positions.size());
  std::copy(positions.begin(), positions.end(), s.mesh.positions.begin());

  s.frame = UnitFrame::of(bounds(s.mesh));
  sites::SitesData::Refit& refit = s.last_refit;
  sites::place(s.regions, s.mesh.positions, refit.placed);
  sites::find_leaf_boxes(s.regions, s.frame, refit.placed, refit.boxes);
  hierarchy::refit_leaves(s.tree, refit.boxes);
  hierarchy::refit(s.wide, s.tree);
  set_inverted(s);
  sites::refit(s.regions, s.frame, refit.placed, s.inverted, s.normals, s.sliver, refit.shapes);
}

const Mesh& Sites::mesh() const {
  return data_->mesh;
}
std::span<const std::array<std::uint32_t, 2>> Sites::edges() const {
  return data_->topology.edges;
}
bool Sites::closed() const {
  return data_->closed;
}
bool Sites::orientable() const {
  return data_->orientation.orientable;
}

}  // namespace sdm

#include <sdm/sites.h>

#include <algorithm>
#include <utility>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/vec.h"
#include "sites/orient_outward.h"
#include "sites/sites_data.h"
#include "mesh/validate.h"

namespace sdm {
namespace {

constexpr std::uint32_t kLeafFaces = FaceBounds::kWidth;
constexpr std::size_t kGrain = 4096;

// What a triangle soup takes while its sites are built; meshes take half of it.
void require_memory_for(const Mesh& mesh) {
  constexpr std::size_t kBytesPerFace = 900, kBytesPerVertex = 60;
  require_memory(kBytesPerFace * mesh.triangles.size() + kBytesPerVertex * mesh.positions.size(), "O2");
}

std::vector<std::uint32_t> faces_with_sites(const Topology& topology) {
  std::vector<std::uint32_t> faces;
  faces.reserve(topology.face_edges.size());
  for (std::size_t f = 0; f < topology.face_edges.size(); ++f)
    if (!topology.ignored(f)) faces.push_back(static_cast<std::uint32_t>(f));
  return faces;
}

// The boxes of faces are those of their vertices, each rounded outwards.
std::vector<FloatBox> face_boxes(const SitesData& s) {
  std::vector<FloatBox> corners(s.mesh.positions.size()), boxes(s.mesh.triangles.size());
  parallel_for(corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 p = s.frame.to_unit(s.mesh.positions[v]);
      corners[v] = FloatBox::around({p, p});
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

void orient_outward(SitesData& s) {
  if (!s.orientation.orientable)
    s.inverted.assign(s.mesh.triangles.size(), 0);
  else if (s.closed)
    orient_outward(s.mesh.positions, s.frame, s.mesh.triangles, s.orientation, s.shells, s.tree, s.inverted);
  else
    s.inverted = s.orientation.turned;
}

}  // namespace

Sites::Sites(Mesh mesh) : impl_(std::make_unique<Impl>()) {
  validate(mesh);
  require_memory_for(mesh);
  Impl& s = *impl_;
  s.mesh = std::move(mesh);
  const auto& triangles = s.mesh.triangles;
  s.frame = UnitFrame::of(bounds(s.mesh));
  s.topology = build_topology(s.mesh.positions.size(), triangles);
  parallel_invoke(
      [&] {
        s.vertex_faces = vertex_faces(s.mesh.positions.size(), triangles, s.topology);
        s.orientation = orient(triangles, s.topology);
        s.closed = s.topology.closed();
        if (s.closed && s.orientation.orientable) s.shells = find_shells(s.orientation);
        s.alike = s.closed && s.orientation.orientable && std::ranges::count(s.orientation.turned, 1) == 0;
      },
      [&] {
        s.tree = build_aabb_tree(face_boxes(s), faces_with_sites(s.topology), kLeafFaces);
        s.wide = collapse(s.tree);
      });
  s.regions = build_regions(
      {s.mesh.positions, triangles, s.topology, s.vertex_faces, s.orientation.orientable, s.frame.scale},
      s.tree);
  s.normals = {std::vector<Vec3>(triangles.size()), std::vector<Vec3>(s.mesh.positions.size())};
  s.sliver.resize(triangles.size());
  orient_outward(s);
  Impl::Refit refit;  // of a mesh that stays nothing is kept
  place(s.regions, s.mesh.positions, refit.placed);
  sdm::refit(s.regions, s.frame, refit.placed, s.inverted, s.normals, s.sliver, refit.shapes);
}

Sites::~Sites() = default;
Sites::Sites(Sites&&) noexcept = default;
Sites& Sites::operator=(Sites&&) noexcept = default;

void Sites::refit(std::span<const Vec3> positions) {
  Impl& s = *impl_;
  validate_positions(positions, s.mesh.positions.size());
  std::copy(positions.begin(), positions.end(), s.mesh.positions.begin());

  s.frame = UnitFrame::of(bounds(s.mesh));
  Impl::Refit& refit = s.last_refit;
  place(s.regions, s.mesh.positions, refit.placed);
  find_leaf_boxes(s.regions, s.frame, refit.placed, refit.boxes);
  refit_leaves(s.tree, refit.boxes);
  sdm::refit(s.wide, s.tree);
  orient_outward(s);
  sdm::refit(s.regions, s.frame, refit.placed, s.inverted, s.normals, s.sliver, refit.shapes);
}

const Mesh& Sites::mesh() const {
  return impl_->mesh;
}
std::span<const std::array<std::uint32_t, 2>> Sites::edges() const {
  return impl_->topology.edges;
}
bool Sites::closed() const {
  return impl_->closed;
}
bool Sites::orientable() const {
  return impl_->orientation.orientable;
}

}  // namespace sdm

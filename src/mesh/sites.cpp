#include <sdm/error.h>
#include <sdm/sites.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/parallel.h"
#include "core/vec.h"
#include "mesh/outward.h"
#include "mesh/sites_impl.h"

namespace sdm {
namespace {

constexpr std::uint32_t kLeafFaces = 8;
constexpr std::size_t kGrain = 4096;

std::vector<std::uint32_t> faces_with_sites(const Topology& topology) {
  std::vector<std::uint32_t> faces;
  for (std::size_t f = 0; f < topology.face_edges.size(); ++f)
    if (!topology.ignored(f)) faces.push_back(static_cast<std::uint32_t>(f));
  return faces;
}

std::vector<Vec3> to_unit(const UnitFrame& frame, const std::vector<Vec3>& positions) {
  std::vector<Vec3> unit(positions.size());
  parallel_for(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) unit[v] = frame.to_unit(positions[v]);
  });
  return unit;
}

std::vector<Box> face_boxes(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  std::vector<Box> boxes(triangles.size());
  parallel_for(triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::uint32_t v : triangles[f]) extend(boxes[f], positions[v]);
  });
  return boxes;
}

}  // namespace

Sites::Sites(Mesh mesh) : impl_(std::make_unique<Impl>()) {
  validate(mesh);
  Impl& s = *impl_;
  s.mesh = std::move(mesh);
  const auto& triangles = s.mesh.triangles;
  s.topology = build_topology(s.mesh.positions.size(), triangles);
  s.vertex_faces = vertex_faces(s.mesh.positions.size(), triangles, s.topology);
  const Orientation orientation = orient(triangles, s.topology);
  s.orientable = orientation.orientable;
  s.closed = true;
  for (std::size_t e = 0; e < s.topology.edges.size(); ++e) s.closed &= s.topology.edge_faces(e).size() == 2;
  s.frame = UnitFrame::of(bounds(s.mesh));
  const std::vector<Vec3> unit = to_unit(s.frame, s.mesh.positions);
  s.tree = build_aabb_tree(face_boxes(unit, triangles), faces_with_sites(s.topology), kLeafFaces);
  s.wide = collapse(s.tree);
  s.inverted = s.closed && s.orientable ? find_inverted(unit, triangles, orientation, s.tree)
                                        : std::vector<std::uint8_t>(triangles.size(), 0);
  s.regions = build_regions(unit, triangles, s.topology, s.tree);
  s.normals = build_pseudonormals(s.mesh.positions, triangles, s.vertex_faces, s.inverted);
}

Sites::~Sites() = default;
Sites::Sites(Sites&&) noexcept = default;
Sites& Sites::operator=(Sites&&) noexcept = default;

void Sites::refit(std::span<const Vec3> positions) {
  Impl& s = *impl_;
  if (positions.size() != s.mesh.positions.size())
    throw Error("the mesh has " + std::to_string(s.mesh.positions.size()) + " vertices, but " +
                std::to_string(positions.size()) + " new positions were given");
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!finite(positions[v]))
      throw Error("the new position of vertex " + std::to_string(v) + " is not finite");
  std::copy(positions.begin(), positions.end(), s.mesh.positions.begin());

  s.frame = UnitFrame::of(bounds(s.mesh));
  const std::vector<Vec3> unit = to_unit(s.frame, s.mesh.positions);
  sdm::refit(s.tree, face_boxes(unit, s.mesh.triangles));
  sdm::refit(s.wide, s.tree);
  sdm::refit(s.regions, unit, s.mesh.triangles, s.topology);
  s.normals = build_pseudonormals(s.mesh.positions, s.mesh.triangles, s.vertex_faces, s.inverted);
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
  return impl_->orientable;
}

}  // namespace sdm

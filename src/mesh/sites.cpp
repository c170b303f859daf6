#include <sdm/error.h>
#include <sdm/sites.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/parallel.h"
#include "core/vec.h"
#include "mesh/outward.h"
#include "mesh/sites_impl.h"
#include "mesh/validate.h"

namespace sdm {
namespace {

constexpr std::uint32_t kLeafFaces = FaceBounds::kWidth;
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

// Faces whose smallest height is below this share of their longest side have normals of rounding errors.
constexpr double kSliver = 1e-9;

std::vector<std::uint8_t> find_slivers(const std::vector<Vec3>& p, const std::vector<Triangle>& triangles) {
  std::vector<std::uint8_t> sliver(triangles.size());
  parallel_for(triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto [a, b, c] = triangles[f];
      const double longest =
          std::max({squared_norm(p[b] - p[a]), squared_norm(p[c] - p[b]), squared_norm(p[a] - p[c])});
      sliver[f] = !(norm(cross(p[b] - p[a], p[c] - p[a])) > kSliver * longest);
    }
  });
  return sliver;
}

// What signs need, brought up to date with the positions and the tree.
void find_outside(Sites::Impl& s, const std::vector<Vec3>& unit) {
  const auto& triangles = s.mesh.triangles;
  s.inverted = !s.orientation.orientable ? std::vector<std::uint8_t>(triangles.size(), 0)
               : s.closed                ? find_inverted(unit, triangles, s.orientation, s.tree)
                                         : s.orientation.turned;
  s.normals = build_pseudonormals(s.mesh.positions, triangles, s.vertex_faces, s.inverted);
  s.sliver = find_slivers(unit, triangles);
}

}  // namespace

Sites::Sites(Mesh mesh) : impl_(std::make_unique<Impl>()) {
  validate(mesh);
  Impl& s = *impl_;
  s.mesh = std::move(mesh);
  const auto& triangles = s.mesh.triangles;
  s.topology = build_topology(s.mesh.positions.size(), triangles);
  s.vertex_faces = vertex_faces(s.mesh.positions.size(), triangles, s.topology);
  s.orientation = orient(triangles, s.topology);
  s.closed = true;
  for (std::size_t e = 0; e < s.topology.edges.size(); ++e) s.closed &= s.topology.edge_faces(e).size() == 2;
  s.alike = s.closed && s.orientation.orientable && std::ranges::count(s.orientation.turned, 1) == 0;

  s.frame = UnitFrame::of(bounds(s.mesh));
  const std::vector<Vec3> unit = to_unit(s.frame, s.mesh.positions);
  s.tree = build_aabb_tree(face_boxes(unit, triangles), faces_with_sites(s.topology), kLeafFaces);
  s.wide = collapse(s.tree);
  s.regions = build_regions({unit, triangles, s.topology, s.vertex_faces, s.orientation}, s.tree);
  find_outside(s, unit);
}

Sites::~Sites() = default;
Sites::Sites(Sites&&) noexcept = default;
Sites& Sites::operator=(Sites&&) noexcept = default;

void Sites::refit(std::span<const Vec3> positions) {
  Impl& s = *impl_;
  if (positions.size() != s.mesh.positions.size())
    throw Error("the mesh has " + std::to_string(s.mesh.positions.size()) + " vertices, but " +
                std::to_string(positions.size()) + " new positions were given");
  validate_positions(positions);
  std::copy(positions.begin(), positions.end(), s.mesh.positions.begin());

  s.frame = UnitFrame::of(bounds(s.mesh));
  const std::vector<Vec3> unit = to_unit(s.frame, s.mesh.positions);
  sdm::refit(s.tree, face_boxes(unit, s.mesh.triangles));
  sdm::refit(s.wide, s.tree);
  sdm::refit(s.regions, {unit, s.mesh.triangles, s.topology, s.vertex_faces, s.orientation});
  find_outside(s, unit);
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

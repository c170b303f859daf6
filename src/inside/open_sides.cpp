#include "inside/open_sides.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "geometry/predicates.h"
#include "geometry/vec.h"
#include "inside/face_sides.h"
#include "inside/near_faces.h"
#include "inside/solid.h"
#include "tree/visit.h"

namespace sdm::inside {

OpenSides::OpenSides(const sites::SitesData& sites, const OrientedFaces& closing)
    : sites_(sites),
      closing_(closing),
      boundary_(sites.topology, sites.mesh.positions.size()),
      offset_(offset_beside_faces(sites)),
      clearance_(kClearance / sites.frame.scale) {
  if (offset_ == 0 || !sites.orientation.orientable) return;
  outer_ = std::make_unique<std::atomic<std::int8_t>[]>(sites.mesh.triangles.size());
  for (std::size_t f = 0; f < sites.mesh.triangles.size(); ++f)
    outer_[f].store(kUnknown, std::memory_order_relaxed);
}

std::span<const std::uint32_t> OpenSides::faces_of(SiteType type, const std::uint32_t& site) const {
  if (type == SiteType::face) return {&site, 1};
  return type == SiteType::edge ? sites_.topology.edge_faces(site) : sites_.vertex_faces.of(site);
}

bool OpenSides::is_fan(SiteType type, std::uint32_t site) const {
  if (type == SiteType::face) return true;
  if (type == SiteType::edge) return sites_.topology.edge_faces(site).size() == 2;
  return mesh::is_fan(sites_.topology, site, sites_.vertex_faces.of(site));
}

// A face with an edge or a corner on the boundary is near to a closing face, unless that is somewhere else
// because the faces there are oriented against each other.
bool OpenSides::clear(std::uint32_t face) const {
  if (sites_.sliver[face] != 0 || sites_.topology.ignored(face)) return false;
  thread_local std::vector<std::uint32_t> near;
  find_near_faces(sites_, face, near);
  if (!near.empty()) return false;
  if (closing_.faces.tree.nodes.empty()) return true;
  Box box;
  for (const Vec3& corner : unit_corners(sites_, face)) extend(box, corner);
  const Vec3 margin{kClearance, kClearance, kClearance};
  const auto reach = tree::FloatBox::around({box.lo - margin, box.hi + margin});
  bool met = false;
  const auto enter = [&](tree::Subtree below) {
    return !met && gap(closing_.faces.tree.box(below.root), reach) == Vec3{};
  };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t other : closing_.faces.tree.items_of(leaf)) {
      Box of_other;
      for (const std::uint32_t v : closing_.faces.triangles[other])
        extend(of_other, sites_.frame.to_unit(sites_.mesh.positions[v]));
      met = met || gap(tree::FloatBox::around(of_other), reach) == Vec3{};
    }
  };
  visit(closing_.faces.tree, tree::InOrder{enter, visit_leaf});
  return !met;
}

std::int8_t OpenSides::known_to_neighbour(std::uint32_t face) const {
  for (const std::uint32_t edge : sites_.topology.face_edges[face]) {
    const std::span<const std::uint32_t> faces = sites_.topology.edge_faces(edge);
    if (faces.size() != 2) continue;
    const std::int8_t number = outer_[faces[faces[0] == face ? 1 : 0]].load(std::memory_order_relaxed);
    if (number <= kMost) return number;
  }
  return kUnknown;
}

Vec3 OpenSides::beside(std::uint32_t face) const {
  const auto& [a, b, c] = sites_.mesh.triangles[face];
  const std::vector<Vec3>& p = sites_.mesh.positions;
  return (1.0 / 3) * (p[a] + p[b] + p[c]) + offset_ * sites_.normals.face[face];
}

// Near a face, the side of its plane decides exactly, as for crossings: a point of the plane counts as below.
bool OpenSides::outside(const Vec3& q, const ClosestPoint& closest) const {
  if (closest.type != SiteType::face || closest.distance > clearance_)
    return dot(q - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest)) > 0;
  const auto& [a, b, c] = sites_.mesh.triangles[closest.face];
  const std::vector<Vec3>& p = sites_.mesh.positions;
  return (orientation(p[a], p[b], p[c], q) > 0) != (sites_.inverted[closest.face] != 0);
}

// The end lies in the ball around q that the mesh does not meet.
std::optional<int> OpenSides::crossings_of_closing(const Vec3& q, const ClosestPoint& closest) const {
  if (closing_.faces.tree.nodes.empty()) return 0;
  const Vec3 end = closest.point + offset_ / closest.distance * (q - closest.point);
  return crossings(closing_, {}, q, end);
}

}  // namespace sdm::inside

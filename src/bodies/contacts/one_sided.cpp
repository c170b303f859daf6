#include "bodies/contacts/one_sided.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "geometry/rounding.h"

namespace sdm::contacts {

void OneSidedVertices::start(const shape::Body& on, const shape::Body& other,
                             const mesh::Similarity& to_other, double margin) {
  on_ = &on;
  other_ = &other;
  to_other_ = &to_other;
  margin_ = margin;
  // Nearer points may be on either side.
  rounding_ = kUnitDistanceRounding / internals(other.sites()).frame.scale;
  for (const std::uint32_t vertex : added_) vertices_[vertex] = {};
  added_.clear();
  points_.clear();
  const std::size_t count = internals(on.sites()).regions.points.size();
  if (vertices_.size() < count) vertices_.resize(count);
}

void OneSidedVertices::add_face(const Triangle& corners, bool near) {
  const auto parent = [&](int k) { return vertices_[corners[k]].parent; };
  // Most are joined already.
  if (!near && parent(0) != kNone && parent(0) == parent(1) && parent(1) == parent(2)) return;
  for (const std::uint32_t vertex : corners) {
    Vertex& v = vertices_[vertex];
    if (v.parent == kNone) {
      v.parent = vertex;
      added_.push_back(vertex);
    }
    v.alone = v.alone && near;
  }
  if (near) return;
  std::uint32_t root = find(corners[0]);
  for (const int k : {1, 2}) {
    const std::uint32_t other = find(corners[k]);
    vertices_[std::max(root, other)].parent = std::min(root, other);
    root = std::min(root, other);
  }
  for (const std::uint32_t vertex : corners) vertices_[vertex].parent = root;
}

std::uint32_t OneSidedVertices::find(std::uint32_t vertex) {
  while (vertices_[vertex].parent != vertex)
    vertex = vertices_[vertex].parent = vertices_[vertices_[vertex].parent].parent;
  return vertex;
}

Vec3 OneSidedVertices::at(std::uint32_t vertex) const {
  const sites::SitesData& sites = internals(on_->sites());
  return to_other_->map(sites.mesh.positions[sites.regions.points[vertex].vertex]);
}

const SurfacePoint* OneSidedVertices::measured(std::uint32_t vertex) const {
  const std::uint32_t point = vertices_[vertex].measured;
  return point == kNone ? nullptr : &points_[point];
}

SurfacePoint OneSidedVertices::closest_point(std::uint32_t vertex, std::uint32_t& face) const {
  // The face closest to the vertex before, which is probably a neighbour, is near.
  const SurfacePoint point = measure_near(*other_, at(vertex), face);
  face = point.face;
  return point;
}

OneSidedVertices::Side OneSidedVertices::side_of(const SurfacePoint& point) const {
  return point.distance <= margin_ ? Side::contact : Side::free;
}

// One vertex of a set is measured; where it is so near to the surface that rounding may decide, the next one
// as well.
void OneSidedVertices::find_sides() {
  std::uint32_t face = kNone;
  for (const std::uint32_t vertex : added_) {
    if (vertices_[vertex].alone) continue;
    const std::uint32_t root = find(vertex);
    vertices_[vertex].parent = root;
    if (vertices_[root].side != Side::unknown) continue;
    vertices_[vertex].measured = static_cast<std::uint32_t>(points_.size());
    points_.push_back(closest_point(vertex, face));
    const SurfacePoint& point = points_.back();
    if (std::abs(point.distance) > rounding_) vertices_[root].side = side_of(point);
  }
}

bool OneSidedVertices::is_free(std::uint32_t vertex) const {
  if (const SurfacePoint* point = measured(vertex)) return side_of(*point) == Side::free;
  return !vertices_[vertex].alone && vertices_[vertices_[vertex].parent].side == Side::free;
}

// The side of a vertex alone is kept. Threads that find it at the same time find the same.
SurfacePoint OneSidedVertices::measure(std::uint32_t vertex, std::uint32_t& face) {
  const SurfacePoint point = closest_point(vertex, face);
  Vertex& v = vertices_[vertex];
  if (v.alone) std::atomic_ref(v.side).store(side_of(point), std::memory_order_relaxed);
  return point;
}

bool OneSidedVertices::in_contact(std::uint32_t vertex, std::uint32_t& face) {
  Vertex& v = vertices_[vertex];
  if (!v.alone) return !is_free(vertex);
  const Side known = std::atomic_ref(v.side).load(std::memory_order_relaxed);
  return (known == Side::unknown ? side_of(measure(vertex, face)) : known) == Side::contact;
}

}  // namespace sdm::contacts

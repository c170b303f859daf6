#include "proximity/contacts/one_sided.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/vec.h"

namespace sdm::contacts {

void OneSidedVertices::start(const shape::Body& on, const shape::Body& other,
                             const mesh::Similarity& to_other, double margin) {
  constexpr double kRounding = 1e-9;  // in units of the frame: nearer points may be on either side
  on_ = &on, other_ = &other, to_other_ = &to_other, margin_ = margin;
  rounding_ = kRounding / internals(other.sites()).frame.scale;
  for (const std::uint32_t vertex : added_) vertices_[vertex] = {};
  added_.clear(), points_.clear(), face_ = kNone;
  const std::size_t count = internals(on.sites()).regions.points.size();
  if (vertices_.size() < count) vertices_.resize(count);
}

void OneSidedVertices::add_face(const Triangle& corners, bool near) {
  const auto parent = [&](int k) { return vertices_[corners[k]].parent; };
  // Most are joined already.
  if (!near && parent(0) != kNone && parent(0) == parent(1) && parent(1) == parent(2)) return;
  for (const std::uint32_t vertex : corners) {
    Vertex& v = vertices_[vertex];
    if (v.parent == kNone) v.parent = vertex, added_.push_back(vertex);
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

SurfacePoint OneSidedVertices::measure(std::uint32_t vertex) {
  // The face closest to the vertex before, which is probably a neighbour, is near.
  const SurfacePoint point = measure_near(*other_, at(vertex), face_);
  face_ = point.face;
  return point;
}

OneSidedVertices::Side OneSidedVertices::known_side(std::uint32_t vertex) {
  if (const SurfacePoint* point = measured(vertex))
    return point->distance <= margin_ ? Side::contact : Side::free;
  return vertices_[vertex].alone ? Side::unknown : vertices_[find(vertex)].side;
}

bool OneSidedVertices::in_contact(std::uint32_t vertex) {
  const Side known = known_side(vertex);
  if (known != Side::unknown) return known == Side::contact;
  vertices_[vertex].measured = static_cast<std::uint32_t>(points_.size());
  points_.push_back(measure(vertex));
  const bool contact = points_.back().distance <= margin_;
  // So near to the surface, rounding may decide.
  if (!vertices_[vertex].alone && std::abs(points_.back().distance) > rounding_)
    vertices_[find(vertex)].side = contact ? Side::contact : Side::free;
  return contact;
}

}  // namespace sdm::contacts

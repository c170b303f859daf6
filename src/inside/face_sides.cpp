#include "inside/face_sides.h"

#include <algorithm>

#include "core/cancellation.h"
#include "inside/near_faces.h"
#include "inside/solid.h"

namespace sdm::inside {
namespace {

// Sides of so many faces are found one by one, however few there are.
constexpr std::size_t kOneByOne = 256;

}  // namespace

double offset_beside_faces(const sites::SitesData& sites) {
  const double unit = 1 / sites.frame.scale;
  const tree::FloatBox& box = sites.tree.box(0);
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    largest = std::max({largest, std::abs(sites.frame.origin[k] + unit * box.lower[k]),
                        std::abs(sites.frame.origin[k] + unit * box.upper[k])});
  const double rounding = 1e-14 * largest;
  const double offset = std::max(1e-9 * unit, rounding);
  return offset > 0.25 * kClearance * unit ? 0 : offset;
}

FaceSides::FaceSides(const sites::SitesData& solid)
    : solid_(&solid), sides_(std::make_unique<std::atomic<Sides>[]>(solid.mesh.triangles.size())) {
  renew();
}

void FaceSides::renew() {
  offset_ = offset_beside_faces(*solid_);
  for (std::size_t f = 0; f < solid_->mesh.triangles.size(); ++f)
    sides_[f].store(Sides::unknown, std::memory_order_relaxed);
  found_ = direct_ = walked_ = 0;
  known_ = false;
}

Sides FaceSides::of_face(std::uint32_t face) const {
  Sides sides = sides_[face].load(std::memory_order_relaxed);
  if (sides != Sides::unknown) return sides;
  // Faces that other threads ask for meanwhile are found one by one.
  if (found_.fetch_add(1, std::memory_order_relaxed) == kOneByOne + solid_->mesh.triangles.size() / 32)
    find_all();
  sides = sides_[face].load(std::memory_order_relaxed);
  if (sides == Sides::unknown) sides_[face].store(sides = find(face), std::memory_order_relaxed);
  return sides;
}

bool FaceSides::walked(std::size_t queries) const {
  constexpr std::size_t kQueriesPerFace = 4;
  return !known_.load(std::memory_order_relaxed) && walked_.fetch_add(queries, std::memory_order_relaxed) <
                                                        kQueriesPerFace * solid_->mesh.triangles.size();
}

bool FaceSides::direct(std::uint32_t face) const {
  if (sides_[face].load(std::memory_order_relaxed) != Sides::unknown) return false;
  const std::size_t enough = kOneByOne + solid_->mesh.triangles.size() / 2;
  const std::size_t before = direct_.fetch_add(1, std::memory_order_relaxed);
  if (before == enough) find_all();
  return before < enough;
}

Sides FaceSides::of_site(SiteType type, std::uint32_t site) const {
  if (type == SiteType::face) return of_face(site);
  const std::span<const std::uint32_t> faces =
      type == SiteType::edge ? solid_->topology.edge_faces(site) : solid_->vertex_faces.of(site);
  const Sides first = of_face(faces.front());
  for (const std::uint32_t face : faces.subspan(1))
    if (first == Sides::mixed || of_face(face) != first) return Sides::mixed;
  return type == SiteType::vertex && !mesh::is_fan(solid_->topology, site, faces) ? Sides::mixed : first;
}

Sides FaceSides::find(std::uint32_t face) const {
  if (offset_ == 0 || solid_->sliver[face] || solid_->topology.ignored(face)) return Sides::mixed;
  thread_local std::vector<std::uint32_t> near;
  find_near_faces(*solid_, face, near);
  if (!near.empty()) return Sides::mixed;
  const Sides sides = known_to_neighbour(face);
  return sides != Sides::unknown ? sides : beside(face);
}

// The sides of a face that no other face meets.
Sides FaceSides::beside(std::uint32_t face) const {
  const auto& [a, b, c] = solid_->mesh.triangles[face];
  const std::vector<Vec3>& p = solid_->mesh.positions;
  const Vec3 beside = (1.0 / 3) * (p[a] + p[b] + p[c]) + offset_ * solid_->normals.face[face];
  return sides_by_winding(winding(*solid_, beside));
}

void FaceSides::find_all() const {
  if (offset_ == 0) return;
  thread_local std::vector<std::uint8_t> near, done;
  thread_local std::vector<std::uint32_t> waiting;
  flag_faces_with_near(*solid_, near);
  const auto open = [&](std::uint32_t face) {
    return near[face] == 0 && solid_->sliver[face] == 0 && !solid_->topology.ignored(face);
  };
  done.assign(near.size(), 0);
  Poll due(1024);
  for (std::uint32_t first = 0; first < near.size(); ++first) {
    if (done[first] != 0) continue;
    done[first] = 1;
    if (!open(first)) {
      sides_[first].store(Sides::mixed, std::memory_order_relaxed);
      continue;
    }
    const Sides sides = beside(first);
    // Flood fill: faces that are connected by edges across which the winding number is the same.
    waiting.assign(1, first);
    while (!waiting.empty()) {
      due();
      const std::uint32_t face = waiting.back();
      waiting.pop_back();
      sides_[face].store(sides, std::memory_order_relaxed);
      for (const std::uint32_t edge : solid_->topology.face_edges[face])
        for (const std::uint32_t other : solid_->topology.edge_faces(edge))
          if (done[other] == 0 && open(other)) {
            done[other] = 1;
            waiting.push_back(other);
          }
    }
  }
  known_.store(true, std::memory_order_relaxed);
}

// The faces of an edge have the same winding number beside them if no face meets one of them.
Sides FaceSides::known_to_neighbour(std::uint32_t face) const {
  for (const std::uint32_t edge : solid_->topology.face_edges[face])
    for (const std::uint32_t other : solid_->topology.edge_faces(edge)) {
      const Sides sides = sides_[other].load(std::memory_order_relaxed);
      if (sides != Sides::unknown && sides != Sides::mixed) return sides;
    }
  return Sides::unknown;
}

}  // namespace sdm::inside

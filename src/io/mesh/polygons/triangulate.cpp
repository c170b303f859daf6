#include "io/mesh/polygons/triangulate.h"

#include <cmath>
#include <utility>

#include "geometry/vec.h"

namespace sdm::io {
namespace {

// Smaller polygons are searched corner by corner. Where corners are collinear up to rounding, the index's
// boxes exclude some that the test of single corners would not, and so other ears may be chosen.
constexpr std::size_t kIndexedCorners = 1024;

// Newell's normal of a polygon, which need not be planar: twice the area vector.
Vec3 area_vector(std::span<const Vec3> points) {
  Vec3 n{};
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    n += cross(points[i] - points[0], points[i + 1] - points[0]);
  return n;
}

}  // namespace

// Drops the largest coordinate of the polygon's normal, which keeps the orientation and makes no area vanish.
void Triangulator::project() {
  const Vec3 n = area_vector(points_);
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) > std::abs(n[k])) k = i;
  int i = (k + 1) % 3, j = (k + 2) % 3;
  if (n[k] < 0) std::swap(i, j);
  plane_.resize(points_.size());
  for (std::size_t p = 0; p < points_.size(); ++p) plane_[p] = {points_[p][i], points_[p][j]};
}

// Twice the signed area of a triangle; positive if a, b, c have the polygon's orientation.
double Triangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return cross(plane_[b] - plane_[a], plane_[c] - plane_[a]);
}

// Whether p lies in the triangle or on its boundary. Corners that coincide with one of the triangle's belong
// to bridges to holes and do not count.
bool Triangulator::blocks(std::uint32_t p, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  if (plane_[p] == plane_[a] || plane_[p] == plane_[b] || plane_[p] == plane_[c]) return false;
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

// A corner is an ear if it is convex and no other corner blocks its triangle. If any corner blocks it, a
// non-convex one does.
bool Triangulator::is_ear(std::uint32_t b) const {
  if (!corners_[b].convex) return false;
  const std::uint32_t a = corners_[b].previous, c = corners_[b].next;
  if (indexed_)
    return !reflex_.any_in({plane_[a], plane_[b], plane_[c]},
                           [&](std::uint32_t p) { return blocks(p, a, b, c); });
  for (std::uint32_t p = corners_[c].next; p != a; p = corners_[p].next)
    if (!corners_[p].convex && blocks(p, a, b, c)) return false;
  return true;
}

Triangulator::Rank Triangulator::rank(std::uint32_t corner) const {
  return {corners_[corner].ear ? Kind::ear : Kind::other, corners_[corner].cut};
}

// The ear with the shortest diagonal; if a self-intersecting polygon has no ear, the corner with the shortest
// diagonal. Of equal ones, the first from `start` on.
std::uint32_t Triangulator::best_ear(std::uint32_t start) const {
  if (indexed_) return static_cast<std::uint32_t>(ranks_.least_from(start));
  std::uint32_t best = start;
  for (std::uint32_t c = corners_[start].next; c != start; c = corners_[c].next)
    if (corners_[c].ear != corners_[best].ear ? corners_[c].ear : corners_[c].cut < corners_[best].cut)
      best = c;
  return best;
}

void Triangulator::link_corners() {
  const auto n = static_cast<std::uint32_t>(points_.size());
  corners_.resize(n);
  for (std::uint32_t b = 0; b < n; ++b) {
    const std::uint32_t a = b == 0 ? n - 1 : b - 1, c = b + 1 == n ? 0 : b + 1;
    corners_[b] = {a, c, turn(a, b, c) > 0, false, squared_norm(points_[c] - points_[a])};
  }
  indexed_ = n > kIndexedCorners;
  if (indexed_) {
    reflex_.reset(plane_);
    for (std::uint32_t c = 0; c < n; ++c)
      if (!corners_[c].convex) reflex_.set(c, true);
  }
  for (std::uint32_t c = 0; c < n; ++c) corners_[c].ear = is_ear(c);
  if (indexed_) {
    std::vector<Rank> ranks(n);
    for (std::uint32_t c = 0; c < n; ++c) ranks[c] = rank(c);
    ranks_.reset(ranks, {Kind::clipped, 0});
  }
}

void Triangulator::clip(std::uint32_t ear) {
  const std::uint32_t previous = corners_[ear].previous, next = corners_[ear].next;
  triangles_.push_back({previous, ear, next});
  if (indexed_) {
    reflex_.set(ear, false);
    ranks_.set(ear, {Kind::clipped, 0});
  }
  corners_[previous].next = next;
  corners_[next].previous = previous;
  for (const std::uint32_t b : {previous, next}) {
    const std::uint32_t a = corners_[b].previous, c = corners_[b].next;
    corners_[b].convex = turn(a, b, c) > 0;
    if (indexed_) reflex_.set(b, !corners_[b].convex);
    corners_[b].ear = is_ear(b);
    corners_[b].cut = squared_norm(points_[c] - points_[a]);
    if (indexed_) ranks_.set(b, rank(b));
  }
}

std::span<const std::array<std::uint32_t, 3>> Triangulator::triangulate(std::span<const Vec3> points) {
  triangles_.clear();
  if (points.size() == 3) {
    triangles_.push_back({0, 1, 2});
    return triangles_;
  }
  points_ = points;
  project();
  link_corners();
  std::uint32_t any = 0;
  for (std::size_t left = points.size(); left > 3; --left) {
    const std::uint32_t ear = best_ear(any);
    any = corners_[ear].next;
    clip(ear);
  }
  triangles_.push_back({corners_[any].previous, any, corners_[any].next});
  return triangles_;
}

}  // namespace sdm::io

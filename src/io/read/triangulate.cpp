#include "io/read/triangulate.h"

#include <limits>

#include "core/vec.h"

namespace sdm::io {
namespace {

// Newell's normal: the area vector of a polygon, planar or not (twice over).
Vec3 area_vector(std::span<const Vec3> points) {
  Vec3 n{};
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    n += cross(points[i] - points[0], points[i + 1] - points[0]);
  return n;
}

}  // namespace

// Drops the coordinate in which the polygon's normal is longest: the sense of turn stays, no area vanishes.
void Triangulator::project(std::span<const Vec3> points) {
  const Vec3 n = area_vector(points);
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) > std::abs(n[k])) k = i;
  int i = (k + 1) % 3, j = (k + 2) % 3;
  if (n[k] < 0) std::swap(i, j);
  plane_.resize(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) plane_[p] = {points[p][i], points[p][j]};
}

// Twice the signed area of a triangle: positive where a, b, c turn as the polygon does.
double Triangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return cross(plane_[b] - plane_[a], plane_[c] - plane_[a]);
}

// A corner is an ear when it is convex and its triangle holds no other corner, its border included. If it
// holds any, it holds one that is not convex. Corners on the same spot as one of the triangle's are bridges
// to holes and do not count.
void Triangulator::classify(std::uint32_t b) {
  const std::uint32_t a = corners_[b].previous, c = corners_[b].next;
  corners_[b].convex = turn(a, b, c) > 0;
  corners_[b].ear = corners_[b].convex;
  for (std::uint32_t p = corners_[c].next; corners_[b].ear && p != a; p = corners_[p].next) {
    if (corners_[p].convex || plane_[p] == plane_[a] || plane_[p] == plane_[b] || plane_[p] == plane_[c])
      continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) corners_[b].ear = false;
  }
}

// The ear with the shortest cut; where a polygon that crosses itself has none, any corner with the shortest
// cut.
std::uint32_t Triangulator::best_ear(std::uint32_t start) const {
  std::uint32_t best = start;
  for (std::uint32_t c = corners_[start].next; c != start; c = corners_[c].next) {
    if (corners_[c].ear != corners_[best].ear ? corners_[c].ear : corners_[c].cut < corners_[best].cut)
      best = c;
  }
  return best;
}

std::span<const std::array<std::uint32_t, 3>> Triangulator::triangulate(std::span<const Vec3> points) {
  const auto n = static_cast<std::uint32_t>(points.size());
  triangles_.clear();
  if (n == 3) {
    triangles_.push_back({0, 1, 2});
    return triangles_;
  }
  project(points);
  const auto measure = [&](std::uint32_t c) {
    corners_[c].cut = squared_norm(points[corners_[c].next] - points[corners_[c].previous]);
  };
  corners_.resize(n);
  for (std::uint32_t c = 0; c < n; ++c) corners_[c] = {(c + n - 1) % n, (c + 1) % n, false, false, 0};
  for (std::uint32_t c = 0; c < n; ++c)
    corners_[c].convex = turn(corners_[c].previous, c, corners_[c].next) > 0, measure(c);
  for (std::uint32_t c = 0; c < n; ++c) classify(c);

  std::uint32_t any = 0;
  for (std::uint32_t left = n; left > 3; --left) {
    const std::uint32_t ear = best_ear(any);
    const auto [previous, next, convex, is_ear, cut] = corners_[ear];
    triangles_.push_back({previous, ear, next});
    corners_[previous].next = next;
    corners_[next].previous = previous;
    for (const std::uint32_t c : {previous, next}) classify(c), measure(c);
    any = next;
  }
  triangles_.push_back({corners_[any].previous, any, corners_[any].next});
  return triangles_;
}

}  // namespace sdm::io

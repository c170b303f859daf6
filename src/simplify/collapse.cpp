#include "simplify/collapse.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/cancellation.h"
#include "simplify/collapse_sequence.h"

namespace sdm::simplify {
namespace {

/// The positions of a triangle, the least first, and whether the others are in ascending order.
struct Turned {
  Triangle vertices;
  bool ascending;
};

Turned turned(const Wedges& wedges, const Triangle& t) {
  Triangle v{wedges.vertex[t[0]], wedges.vertex[t[1]], wedges.vertex[t[2]]};
  std::ranges::rotate(v, std::ranges::min_element(v));
  const bool ascending = v[1] < v[2];
  if (!ascending) std::swap(v[1], v[2]);
  return {v, ascending};
}

// Removes pairs of opposite faces that no two faces of the wedges are.
void remove_new_pairs(const Wedges& wedges, std::vector<Triangle>& triangles) {
  std::map<Triangle, std::array<std::size_t, 2>> sides;  // how many faces have each side
  std::vector<Triangle> sorted;
  sorted.reserve(triangles.size());
  for (const Triangle& t : triangles) sorted.push_back(turned(wedges, t).vertices);
  std::vector<Triangle> all = sorted;
  std::ranges::sort(all);
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i] == all[i - 1]) sides[all[i]] = {};
  if (sides.empty()) return;
  for (const Triangle& t : wedges.triangles)
    if (sides.contains(turned(wedges, t).vertices)) sides.erase(turned(wedges, t).vertices);
  for (const Triangle& t : triangles)
    if (const auto [v, ascending] = turned(wedges, t); sides.contains(v)) ++sides[v][ascending ? 1 : 0];
  std::vector<Triangle> left;
  std::map<Triangle, std::array<std::size_t, 2>> gone;
  for (const Triangle& t : triangles) {
    const auto [v, ascending] = turned(wedges, t);
    if (const auto found = sides.find(v); found != sides.end()) {
      const std::size_t pairs = std::min(found->second[0], found->second[1]);
      if (std::size_t& removed = gone[v][ascending ? 1 : 0]; removed < pairs) {
        ++removed;
        continue;
      }
    }
    left.push_back(t);
  }
  if (!left.empty()) triangles = std::move(left);
}

}  // namespace

Collapsed collapse(const Wedges& wedges, std::span<const Triangle> triangles, const CollapseLimit& limit) {
  poll();
  Collapsed result{std::vector<Triangle>(triangles.size())};
  const auto* const points = wedges.points.data()->data();
  constexpr std::size_t kStride = sizeof(wedges.points[0]);
  const double scale = wedges.size * meshopt_simplifyScale(points, wedges.points.size(), kStride);
  constexpr double kMostError = 1e6;  // its square is a float
  float error = 0;
  const std::size_t corners =
      meshopt_simplify(result.triangles.data()->data(), triangles.data()->data(), 3 * triangles.size(),
                       points, wedges.points.size(), kStride, 3 * std::min(limit.triangles, triangles.size()),
                       static_cast<float>(std::min(limit.error / scale, kMostError)), 0, &error);
  result.triangles.resize(corners / 3);
  result.estimate = scale * error;
  remove_new_pairs(wedges, result.triangles);
  return result;
}

CollapsedMesh after_collapses(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                              std::span<const CollapseOfEdge> collapses, const std::vector<bool>& held) {
  CollapsingMesh mesh(positions, triangles);
  std::vector<std::uint32_t> last(positions.size(), kNone);
  std::vector<bool> gone(positions.size());
  std::vector<MovedFace> moved;
  for (std::uint32_t i = 0; i < collapses.size(); ++i) {
    const CollapseOfEdge& c = collapses[i];
    if (!held.empty()) {
      if (held[i] || last[c.u] != c.before_u || last[c.v] != c.before_v) continue;
      if (gone[c.u] || gone[c.v]) continue;
      if (!mesh.keeps_topology(c.u, c.v) || !mesh.move(c.u, c.v, c.to, moved)) continue;
    }
    mesh.collapse(c.u, c.v, c.to);
    last[c.u] = i;
    gone[c.v] = true;
  }
  std::vector<bool> used(positions.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    if (mesh.is_left(f))
      for (const std::uint32_t v : mesh.triangle(f)) used[v] = true;
  CollapsedMesh result{mesh.mesh(), {}};
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) result.last.push_back(last[v]);
  return result;
}

}  // namespace sdm::simplify

#include "simplify/collapse.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <map>

#include "core/cancellation.h"
#include "simplify/uv_faces.h"

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

/// Vertices that meshoptimizer does not move: it takes those that have more than two wedges for corners of
/// seams, so two more that no face uses are added to each.
class HeldVertices {
 public:
  explicit HeldVertices(const Wedges& wedges) : wedges_(wedges) {}

  /// Holds the vertices of the faces around these ones.
  void add_around(const std::vector<Triangle>& faces, std::span<const Triangle> triangles) {
    std::vector<bool> near(wedges_.positions.size());
    held_.resize(near.size());
    for (const Triangle& t : faces)
      for (const std::uint32_t w : t) near[wedges_.vertex[w]] = true;
    const auto is_near = [&](std::uint32_t w) { return near[wedges_.vertex[w]]; };
    for (const Triangle& t : triangles)
      if (std::ranges::any_of(t, is_near))
        for (const std::uint32_t w : t) held_[wedges_.vertex[w]] = true;
    points_ = wedges_.points;
    std::vector<bool> added(held_.size());
    for (std::size_t w = 0; w < wedges_.vertex.size(); ++w) {
      if (const std::uint32_t v = wedges_.vertex[w]; !held_[v] || added[v]) continue;
      added[wedges_.vertex[w]] = true;
      points_.insert(points_.end(), 2, wedges_.points[w]);
    }
  }
  [[nodiscard]] std::span<const std::array<float, 3>> points() const {
    return points_.empty() ? wedges_.points : points_;
  }

 private:
  const Wedges& wedges_;
  std::vector<bool> held_;
  std::vector<std::array<float, 3>> points_;  ///< of wedges, and the added ones; empty: none are held
};

Collapsed collapse_once(const Wedges& wedges, std::span<const std::array<float, 3>> points,
                        std::span<const Triangle> triangles, const CollapseLimit& limit) {
  poll();
  Collapsed result{std::vector<Triangle>(triangles.size())};
  constexpr std::size_t kStride = sizeof(points[0]);
  const double scale = wedges.size * meshopt_simplifyScale(points.data()->data(), points.size(), kStride);
  constexpr double kMostError = 1e6;  // its square is a float
  float error = 0;
  const std::size_t corners = meshopt_simplify(
      result.triangles.data()->data(), triangles.data()->data(), 3 * triangles.size(), points.data()->data(),
      points.size(), kStride, 3 * std::min(limit.triangles, triangles.size()),
      static_cast<float>(std::min(limit.error / scale, kMostError)), 0, &error);
  result.triangles.resize(corners / 3);
  result.estimate = scale * error;
  remove_new_pairs(wedges, result.triangles);
  return result;
}

}  // namespace

Collapsed collapse(const Wedges& wedges, std::span<const Triangle> triangles, const CollapseLimit& limit) {
  constexpr int kMostHoldings = 4, kMostLimits = 4;
  CollapseLimit smaller = limit;
  for (int limits = 0; limits < kMostLimits; ++limits) {
    HeldVertices held(wedges);
    for (int holdings = 0; holdings <= kMostHoldings; ++holdings) {
      Collapsed result = collapse_once(wedges, held.points(), triangles, smaller);
      const std::vector<std::uint32_t> wrong = mend_in_texture(wedges, result.triangles);
      if (wrong.empty()) return result;
      std::vector<Triangle> faces;
      for (const std::uint32_t f : wrong) faces.push_back(result.triangles[f]);
      held.add_around(faces, triangles);
    }
    smaller.triangles *= 2;
    smaller.error /= 2;
  }
  return {{triangles.begin(), triangles.end()}};
}

}  // namespace sdm::simplify

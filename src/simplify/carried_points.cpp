#include "simplify/carried_points.h"

#include <algorithm>
#include <cmath>

#include "geometry/point_triangle.h"
#include "geometry/vec.h"

namespace sdm::simplify {
namespace {

/// The distance to a triangle, for many points.
struct Near : TriangleSides {
  using TriangleSides::TriangleSides;

  /// The squared distance, or any number ≥ `best` if it is not less.
  [[nodiscard]] double squared_distance(const Vec3& p, double best) const {
    const double height = dot(normal, p - corner[0]);
    const double above = height * height * inverse_normal;
    if (above >= best) return above;
    Vec3 foot;
    if (over(p, foot)) return above;
    double least = squared_norm(on_side(0, p) - p);
    least = std::min(least, squared_norm(on_side(1, p) - p));
    return std::min(least, squared_norm(on_side(2, p) - p));
  }
};

double parallelogram(const Corners& t) {
  return norm(cross(t[1] - t[0], t[2] - t[0]));
}

}  // namespace

CarriedPoints::CarriedPoints(std::span<const Vec3> positions, std::span<const Triangle> triangles)
    : first_(triangles.size(), kNone) {
  std::vector<bool> has_face(positions.size());
  double area = 0;
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    for (const std::uint32_t v : triangles[f]) {
      if (!has_face[v]) add(positions[v], f);
      has_face[v] = true;
    }
    area += parallelogram(corners_of(positions, triangles[f]));
  }
  // Points as far from each other as in an even mesh of as many faces, or of so many.
  constexpr double kLeastFaces = 20'000;
  const double spacing = 1.5 * std::sqrt(area / std::max(kLeastFaces, static_cast<double>(triangles.size())));
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    add_between(corners_of(positions, triangles[f]), triangles[f], f, spacing);
}

void CarriedPoints::add(const Vec3& p, std::uint32_t face) {
  next_.push_back(first_[face]);
  first_[face] = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
}

void CarriedPoints::add_between(const Corners& corners, const Triangle& t, std::uint32_t face,
                                double spacing) {
  constexpr double kMost = 64;  // on a side
  for (int k = 0; k < 3; ++k) {
    if (t[k] > t[(k + 1) % 3]) continue;  // the other face at this side has its points
    const Vec3 side = corners[(k + 1) % 3] - corners[k];
    // At least the middle: edges of the input cross those of a mesh that is as fine.
    const double steps = std::clamp(std::floor(norm(side) / spacing), 2.0, kMost);
    for (double i = 1; i < steps; ++i) add(corners[k] + (i / steps) * side, face);
  }
  const double steps = std::min(kMost, std::floor(std::sqrt(parallelogram(corners)) / spacing));
  for (double i = 1; i < steps; ++i)
    for (double j = 1; i + j < steps; ++j)
      add(corners[0] + (i / steps) * (corners[1] - corners[0]) + (j / steps) * (corners[2] - corners[0]),
          face);
}

double CarriedPoints::measure(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v,
                              std::span<const MovedFace> moved, double enough) {
  found_.clear();
  std::vector<Near> near;
  near.reserve(moved.size());
  for (const MovedFace& m : moved) near.emplace_back(m.corners);
  double largest = 0;
  const double abort = enough * enough;
  const auto measure_face = [&](std::uint32_t face) {
    for (std::uint32_t i = first_[face]; i != kNone; i = next_[i]) {
      double least = kInfinity;
      std::uint32_t nearest = 0;
      for (std::uint32_t n = 0; n < near.size(); ++n)
        if (const double d = near[n].squared_distance(points_[i], least); d < least) {
          least = d;
          nearest = n;
        }
      found_.emplace_back(i, nearest);
      largest = std::max(largest, least);
      if (largest > abort) return;
    }
  };
  for (const std::uint32_t f : mesh.faces_of(u)) {
    measure_face(f);
    if (largest > abort) return std::sqrt(largest);
  }
  for (const std::uint32_t f : mesh.faces_of(v)) {
    if (std::ranges::find(mesh.triangle(f), u) != mesh.triangle(f).end()) continue;
    measure_face(f);
    if (largest > abort) break;
  }
  return std::sqrt(largest);
}

void CarriedPoints::carry(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v,
                          std::span<const MovedFace> moved) {
  for (const std::uint32_t w : {u, v})
    for (const std::uint32_t f : mesh.faces_of(w)) first_[f] = kNone;
  for (const auto& [point, nearest] : found_) {
    std::uint32_t& first = first_[moved[nearest].face];
    next_[point] = first;
    first = point;
  }
}

}  // namespace sdm::simplify

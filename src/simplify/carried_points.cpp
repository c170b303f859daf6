#include "simplify/carried_points.h"

#include <sdm/closest_points.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sdm::simplify {
namespace {

// A point that is over a face at this share of the allowed distance at most is not compared with others.
constexpr double kSettled = 0.5;
// A face carries about so many points: of more, every second one, and those at this share of the largest
// distance.
constexpr std::uint32_t kMostPoints = 64;
constexpr double kFar = 0.7;

double parallelogram(const Corners& t) {
  return norm(cross(t[1] - t[0], t[2] - t[0]));
}

}  // namespace

// The middle of an edge is always a sample if edges of the input cross those of a mesh that is as fine.
CarriedPoints::CarriedPoints(const Mesh& input) {
  add_all(input, input.triangles.size(), 2);
}

CarriedPoints::CarriedPoints(const Mesh& input, const Sites& carriers) {
  add_all(input, carriers.mesh().triangles.size(), 1);
  first_.assign(carriers.mesh().triangles.size(), kNone);
  const std::vector<ClosestPoint> closest = closest_points(carriers, points_);
  double squares = 0;
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    next_[i] = std::exchange(first_[closest[i].face], i);
    squares += closest[i].distance * closest[i].distance;
  }
  first_distance_ = std::sqrt(squares / static_cast<double>(points_.size()));
}

void CarriedPoints::add_all(const Mesh& input, std::size_t carriers, double least_steps) {
  const std::vector<Triangle>& triangles = input.triangles;
  first_.assign(triangles.size(), kNone);
  std::vector<bool> has_face(input.positions.size());
  double area = 0;
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    for (const std::uint32_t v : triangles[f]) {
      if (!has_face[v]) add(input.positions[v], f);
      has_face[v] = true;
    }
    area += parallelogram(corners_of(input, f));
  }
  // Points as far from each other as in an even mesh of as many faces, or of so many.
  constexpr double kLeastFaces = 20'000;
  const double spacing = 1.5 * std::sqrt(area / std::max(kLeastFaces, static_cast<double>(carriers)));
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    add_between(corners_of(input, f), triangles[f], f, spacing, least_steps);
}

void CarriedPoints::add(const Vec3& p, std::uint32_t face) {
  next_.push_back(first_[face]);
  first_[face] = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
  source_.push_back(face);
}

void CarriedPoints::add_between(const Corners& corners, const Triangle& t, std::uint32_t face, double spacing,
                                double least_steps) {
  constexpr double kMost = 64;  // on a side
  for (int k = 0; k < 3; ++k) {
    if (t[k] > t[(k + 1) % 3]) continue;  // the other face at this side has its points
    const Vec3 side = corners[(k + 1) % 3] - corners[k];
    const double steps = std::clamp(std::floor(norm(side) / spacing), least_steps, kMost);
    for (double i = 1; i < steps; ++i) add(corners[k] + (i / steps) * side, face);
  }
  const double steps = std::min(kMost, std::floor(std::sqrt(parallelogram(corners)) / spacing));
  for (double i = 1; i < steps; ++i)
    for (double j = 1; i + j < steps; ++j)
      add(corners[0] + (i / steps) * (corners[1] - corners[0]) + (j / steps) * (corners[2] - corners[0]),
          face);
}

double CarriedPoints::measure(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v,
                              std::span<const MovedFace> moved, double allowed, double enough) {
  found_.clear();
  near_.clear();
  for (const MovedFace& m : moved) near_.emplace_back(m.corners);
  faces_.clear();
  for (const std::uint32_t w : {u, v})
    for (const std::uint32_t f : mesh.faces_of(w))
      if (first_[f] != kNone && (w == u || std::ranges::find(mesh.triangle(f), u) == mesh.triangle(f).end()))
        faces_.push_back(f);
  Farthest farthest;
  const double abort = enough * enough, settled = kSettled * kSettled * allowed * allowed;
  std::uint32_t nearest = 0;
  const auto measure_point = [&](std::uint32_t face, std::uint32_t before, std::uint32_t i) {
    const Vec3& p = points_[i];
    const std::uint32_t first = nearest;
    double least = near_[first].squared_distance(p, kInfinity);
    if (!(least <= settled && near_[first].is_over(p)))
      for (std::uint32_t n = 0; n < near_.size(); ++n) {
        if (n == first) continue;
        if (const double d = near_[n].squared_distance(p, least); d < least) {
          least = d;
          nearest = n;
        }
      }
    found_.push_back({i, nearest, least});
    if (least > farthest.squared) farthest = {least, face, before, i};
    return least <= abort;
  };
  // The first point of each face is the one that was too far before.
  const auto measure_points = [&] {
    for (const std::uint32_t f : faces_)
      if (!measure_point(f, kNone, first_[f])) return;
    for (const std::uint32_t f : faces_)
      for (std::uint32_t before = first_[f], i = next_[before]; i != kNone; before = i, i = next_[i])
        if (!measure_point(f, before, i)) return;
  };
  measure_points();
  farthest_ = farthest.squared;
  const double distance = std::sqrt(farthest_);
  if (distance > allowed && farthest.before != kNone) {
    next_[farthest.before] = next_[farthest.point];
    next_[farthest.point] = first_[farthest.face];
    first_[farthest.face] = farthest.point;
  }
  return distance;
}

void CarriedPoints::carry(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v,
                          std::span<const MovedFace> moved) {
  for (const std::uint32_t w : {u, v})
    for (const std::uint32_t f : mesh.faces_of(w)) first_[f] = kNone;
  carried_.assign(moved.size(), 0);
  for (const Found& f : found_) ++carried_[f.moved];
  const double far = kFar * kFar * farthest_;
  for (std::uint32_t i = 0; i < found_.size(); ++i) {
    const Found& f = found_[i];
    if (carried_[f.moved] > kMostPoints && f.squared <= far && (i & 1) != 0) continue;
    std::uint32_t& first = first_[moved[f.moved].face];
    next_[f.point] = first;
    first = f.point;
  }
}

void CarriedPoints::find_near(std::span<Sample> samples) {
  first_sample_.assign(near_.size() + 1, static_cast<std::uint32_t>(samples.size()));
  for (std::size_t i = samples.size(); i-- > 0;)
    first_sample_[samples[i].moved] = static_cast<std::uint32_t>(i);
  for (const Found& f : found_)
    for (std::uint32_t i = first_sample_[f.moved]; i < first_sample_[f.moved + 1]; ++i) {
      Sample& sample = samples[i];
      const double squared = squared_norm(points_[f.point] - sample.at);
      if (squared >= sample.squared) continue;
      sample.squared = squared;
      sample.near = source_[f.point];
    }
}

}  // namespace sdm::simplify

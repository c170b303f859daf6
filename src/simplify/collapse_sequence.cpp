#include "simplify/collapse_sequence.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "closest/single_point.h"
#include "core/cancellation.h"
#include "geometry/point_triangle.h"
#include "geometry/vec.h"

namespace sdm::simplify {
namespace {

// Planes through borders count so much more than those of faces.
constexpr double kBorderWeight = 3;
// An edge is first tried at this share of the mean distance from the planes: if it is smaller, more edges are
// measured in vain, and if it is larger, edges with a larger error are collapsed before.
constexpr double kExpected = 0.5;
// What the length of an edge adds to its error, relative to that of planes at this distance: on a flat
// surface, where errors are equal, it keeps faces from becoming needles around one vertex.
constexpr double kShort = 1e-6;
// What the mesh does not permit is tried again so many rungs later.
constexpr int kAgain = 4;
// How much larger a deviation is looked for than is allowed.
constexpr double kEnough = 1.3;

}  // namespace

double Ladder::length(int rung) const {
  return size_ * std::pow(kFactor, rung);
}

int Ladder::above(double length) const {
  if (!(length > this->length(kLowest))) return kLowest;
  int rung = static_cast<int>(std::ceil(std::log(length / size_) / std::log(kFactor)));
  while (this->length(rung) < length) ++rung;
  return rung;
}

int Ladder::below(double length) const {
  const int rung = above(length);
  return this->length(rung) > length ? rung - 1 : rung;
}

bool CollapseSequence::Costlier::operator()(const Edge& a, const Edge& b) const {
  return std::tie(a.cost, a.u, a.v) > std::tie(b.cost, b.u, b.v);
}

bool CollapseSequence::Later::operator()(const Edge& a, const Edge& b) const {
  return a.rung > b.rung;
}

CollapseSequence::CollapseSequence(const Mesh& start, const Sites& input, double size)
    : mesh_(start),
      points_(&start == &input.mesh() ? CarriedPoints(start) : CarriedPoints(input.mesh(), Sites(start))),
      sites_(internals(input)),
      ladder_(size),
      middle_(centre(bounds(input.mesh()))),
      faces_(start.triangles.size()),
      quadrics_(start.positions.size()),
      moves_(start.positions.size()),
      last_(start.positions.size(), kNone) {
  // What the points are from the start at first is no reason to try a collapse again and again.
  constexpr double kOfFirst = 2;
  rung_ = ladder_.above(kOfFirst * points_.first_distance());
  const std::vector<Triangle>& triangles = start.triangles;
  add_planes();
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t u = triangles[f][k], v = triangles[f][(k + 1) % 3];
      // An edge has a face in which it ascends unless it is a border, or faces are turned.
      if (u < v) push(u, v);
    }
  for (std::uint32_t u = 0; u < start.positions.size(); ++u)
    for (const std::uint32_t v : mesh_.neighbours(u)) {
      if (v < u) continue;
      const auto ascends = [&](std::uint32_t f) {
        const Triangle& t = triangles[f];
        return (t[0] == u && t[1] == v) || (t[1] == u && t[2] == v) || (t[2] == u && t[0] == v);
      };
      if (std::ranges::none_of(mesh_.faces_of(u), ascends)) push(u, v);
    }
}

void CollapseSequence::add_planes() {
  for (std::uint32_t f = 0; f < faces_; ++f) {
    const Corners c = mesh_.corners(f);
    const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]);
    const double area = norm(normal) / 2;
    if (!(area > 0)) continue;
    const Vec3 n = (0.5 / area) * normal;
    const Triangle& t = mesh_.triangle(f);
    for (int k = 0; k < 3; ++k) {
      quadrics_[t[k]].add_plane(n, dot(n, c[0] - middle_), area / 3);
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const auto has_b = [&](std::uint32_t other) {
        return std::ranges::find(mesh_.triangle(other), b) != mesh_.triangle(other).end();
      };
      if (std::ranges::count_if(mesh_.faces_of(a), has_b) != 1) continue;
      const Vec3 side = c[(k + 1) % 3] - c[k];
      const Vec3 outwards = normalized(cross(side, n));
      for (const std::uint32_t v : {a, b})
        quadrics_[v].add_plane(outwards, dot(outwards, c[k] - middle_), kBorderWeight * squared_norm(side));
    }
  }
}

bool CollapseSequence::is_possible() const {
  constexpr std::size_t kMostFixed = 20;  // 5 % of the vertices
  return mesh_.fixed_vertices() * kMostFixed <= quadrics_.size();
}

CollapseSequence::Target CollapseSequence::target(std::uint32_t u, std::uint32_t v) const {
  Quadric q = quadrics_[u];
  q += quadrics_[v];
  const Vec3 a = mesh_.position(u) - middle_, b = mesh_.position(v) - middle_, half = 0.5 * (a + b);
  Target best{q.minimum(half), 0};
  best.cost = q.at(best.to);
  constexpr double kFar = 2;  // planes that are almost parallel meet far away
  if (!(squared_norm(best.to - half) <= kFar * kFar * squared_norm(b - a))) best.cost = 1e300;
  for (const Vec3& other : {half, a, b})
    if (const double cost = q.at(other); cost < best.cost) best = {other, cost};
  best.to = best.to + middle_;
  return best;
}

void CollapseSequence::push(std::uint32_t u, std::uint32_t v) {
  const double cost = target(u, v).cost;
  const double weight = quadrics_[u].weight + quadrics_[v].weight;
  const int rung = ladder_.above(weight > 0 ? kExpected * std::sqrt(cost / weight) : 0);
  const double length = squared_norm(mesh_.position(u) - mesh_.position(v));
  push({cost + kShort * weight * length, rung, u, v, moves_[u], moves_[v]});
}

void CollapseSequence::push(const Edge& edge) {
  if (edge.rung <= rung_)
    ready_.push(edge);
  else
    later_.push(edge);
}

void CollapseSequence::advance(int rung) {
  if (rung < rung_) return;
  Poll poll(64);
  for (;;) {
    if (ready_.empty()) {
      if (later_.empty() || later_.top().rung > rung) break;
      ends_.push_back({rung_, collapses_.size(), mesh_.size()});
      rung_ = later_.top().rung;
      for (; !later_.empty() && later_.top().rung <= rung_; later_.pop()) ready_.push(later_.top());
      continue;
    }
    poll();
    const Edge edge = ready_.top();
    ready_.pop();
    if (edge.moves_u == moves_[edge.u] && edge.moves_v == moves_[edge.v]) try_collapse(edge);
  }
}

void CollapseSequence::try_collapse(Edge edge) {
  if (!mesh_.keeps_topology(edge.u, edge.v)) {
    edge.rung = rung_ + kAgain;
    push(edge);
    return;
  }
  const Vec3 to = target(edge.u, edge.v).to;
  if (!mesh_.move(edge.u, edge.v, to, moved_)) {
    edge.rung = rung_ + kAgain;
    push(edge);
    return;
  }
  const double allowed = ladder_.length(rung_);
  const double needed = deviation(edge, to, kEnough * allowed);
  if (needed <= allowed) {
    commit(edge, to);
    return;
  }
  edge.rung = std::max(rung_ + 1, ladder_.above(needed));
  push(edge);
}

double CollapseSequence::deviation(const Edge& edge, const Vec3& to, double enough) {
  const double allowed = ladder_.length(rung_);
  const double of_points = points_.measure(mesh_, edge.u, edge.v, moved_, allowed, enough);
  if (of_points > allowed) return of_points;
  return std::max(of_points, deviation_of_faces(edge, to, enough));
}

double CollapseSequence::deviation_of_faces(const Edge& edge, const Vec3& to, double enough) {
  const double allowed = ladder_.length(rung_);
  samples_.clear();
  samples_.push_back({to, 0});
  for (std::uint32_t i = 0; i < moved_.size(); ++i) {
    const MovedFace& m = moved_[i];
    samples_.push_back({(1.0 / 3) * (m.corners[0] + m.corners[1] + m.corners[2]), i});
    for (int k = 0; k < 3; ++k)  // of the two faces at a side, one has it in this direction
      if (m.triangle[k] == edge.u) samples_.push_back({0.5 * (to + m.corners[(k + 1) % 3]), i});
  }
  points_.find_near(samples_);
  double largest = 0;
  for (const CarriedPoints::Sample& sample : samples_) {
    // How much less than is allowed a distance is does not matter. That to a face nearby bounds the search;
    // 0.1 % more is left for rounding.
    double distance = kInfinity;
    if (sample.near != kNone) {
      const double squared =
          squared_norm(closest_on_triangle(sample.at, corners_of(sites_.mesh, sample.near)) - sample.at);
      if (squared <= allowed * allowed) continue;
      distance = std::min(distance, 1.001 * std::sqrt(squared));
    }
    const ClosestPoint found = closest::close_point(sites_, sample.at, distance, allowed);
    largest = std::max(largest, std::min(distance, found.distance));
    if (largest > enough) break;
  }
  return largest;
}

void CollapseSequence::commit(const Edge& edge, const Vec3& to) {
  points_.carry(mesh_, edge.u, edge.v, moved_);
  mesh_.collapse(edge.u, edge.v, to);
  quadrics_[edge.u] += quadrics_[edge.v];
  ++moves_[edge.u];
  ++moves_[edge.v];
  collapses_.push_back({edge.u, edge.v, to, last_[edge.u], last_[edge.v]});
  last_[edge.u] = static_cast<std::uint32_t>(collapses_.size() - 1);
  for (const std::uint32_t w : mesh_.neighbours(edge.u)) push(std::min(edge.u, w), std::max(edge.u, w));
}

std::span<const CollapseOfEdge> CollapseSequence::up_to(int rung) const {
  if (rung >= rung_) return collapses_;
  const auto end = std::ranges::upper_bound(ends_, rung, {}, &End::rung);
  return std::span(collapses_).first(end == ends_.begin() ? 0 : std::prev(end)->collapses);
}

std::size_t CollapseSequence::faces_after(int rung) const {
  if (rung >= rung_) return mesh_.size();
  const auto end = std::ranges::upper_bound(ends_, rung, {}, &End::rung);
  return end == ends_.begin() ? faces_ : std::prev(end)->faces;
}

CollapsedMesh after_collapses(const Mesh& start, std::span<const CollapseOfEdge> collapses,
                              const std::vector<bool>& held) {
  CollapsingMesh mesh(start);
  const std::vector<Triangle>& triangles = start.triangles;
  std::vector<std::uint32_t> last(start.positions.size(), kNone);
  std::vector<bool> gone(last.size());
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
  std::vector<bool> used(last.size());
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    if (mesh.is_left(f))
      for (const std::uint32_t v : mesh.triangle(f)) used[v] = true;
  CollapsedMesh result{mesh.mesh(), {}, {}};
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    if (mesh.is_left(f)) result.faces.push_back(f);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) result.last.push_back(last[v]);
  return result;
}

}  // namespace sdm::simplify

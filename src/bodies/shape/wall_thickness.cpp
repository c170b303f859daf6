#include "bodies/shape/wall_thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "bodies/shape/passages.h"
#include "bodies/shape/wall_column.h"
#include "geometry/point_triangle.h"
#include "geometry/rounding.h"
#include "geometry/triangle.h"

namespace sdm::shape {
namespace {

using inside::Sides;

constexpr double kNoWall = kInfinity;
// Added to angles and their cosines, for rounding.
constexpr double kAngleRounding = 1e-6;
// Weights of corners, at a point of a face that is not right above or below edges of regular meshes.
constexpr Vec3 kWeights{0.4142, 0.3183, 0.2675};
constexpr double kSteepest = 1.3;
constexpr std::size_t kMostAround = 40;
// Relative to the size of the solid: columns are so long, and other walls at most so thick.
constexpr double kDeepest = 0.2, kThickest = 0.04;
// A column with more faces takes too long.
constexpr std::size_t kMostBelow = 2048;
// A ball that meets more is divided anyway.
constexpr std::size_t kMostNodes = 2048;

double angle(const Vec3& a, const Vec3& b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

// The largest angle between the normal of a face and the outward way from a point inside to its closest point
// in an edge of the face, if the edge belongs to this face rather than to the other one.
double angle_at_edge(const sites::SitesData& solid, std::uint32_t face, int side) {
  const std::uint32_t edge = solid.topology.face_edges[face][side];
  if (edge == kNone || solid.topology.edge_faces(edge).size() != 2) return kNoWall;
  const auto faces = solid.topology.edge_faces(edge);
  const std::uint32_t other = faces[0] == face ? faces[1] : faces[0];
  if (solid.sliver[other] != 0) return kNoWall;
  const Vec3 &n = solid.normals.face[face], &m = solid.normals.face[other];
  const Vec3& from = solid.mesh.positions[solid.mesh.triangles[face][side]];
  double height = -kNoWall, reach = 0;
  for (const std::uint32_t v : solid.mesh.triangles[other]) {
    if (v == solid.topology.edges[edge][0] || v == solid.topology.edges[edge][1]) continue;
    const Vec3 to = solid.mesh.positions[v] - from;
    height = std::max(height, dot(n, to));
    reach = std::max(reach, norm(to));
  }
  // No point inside is closest to the interior of a convex edge.
  return height < -kAngleRounding * reach ? 0 : 0.5 * angle(n, m);
}

// The bound at a vertex. With e the directions of its edges, points p = v − b m inside can be closest to the
// vertex v for m in the cone m·e ≥ 0 only, which is spanned by cross products of two of them. Every m in it
// is in the cone of these, and so no farther from one of them than they are from the middle of a cap that
// contains all of them: if it were, with c the middle, (m − c)·g < 0 for all of them, so also (m − c)·m < 0.
// `face` is one of the faces whose normal is next to that one.
double angle_at_vertex(const sites::SitesData& solid, std::uint32_t vertex) {
  std::array<Vec3, kMostAround> edges, normals;
  std::size_t count = 0, face_count = 0;
  const Vec3& at = solid.mesh.positions[vertex];
  for (const std::uint32_t face : solid.vertex_faces.of(vertex)) {
    if (face_count == normals.size() || solid.sliver[face] != 0) return kNoWall;
    normals[face_count++] = solid.normals.face[face];
    for (const std::uint32_t v : solid.mesh.triangles[face]) {
      if (v == vertex) continue;
      const Vec3 e = normalized(solid.mesh.positions[v] - at);
      if (std::ranges::count(std::span(edges).first(count), e) > 0) continue;
      if (count == edges.size()) return kNoWall;
      edges[count++] = e;
    }
  }
  const std::span<const Vec3> around = std::span(edges).first(count),
                              faces = std::span(normals).first(face_count);
  const Vec3 outward = normalized(solid.normals.vertex[vertex]);
  std::array<Vec3, kMostAround * kMostAround> span;
  std::size_t spanning = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const Vec3 c = cross(around[i], around[j]);
      if (!(norm(c) > kAngleRounding)) continue;  // others bound the cone, to rounding
      // The solid is on one side of the vertex for all of the cone, or for half of a line.
      const Vec3 g = dot(c, outward) < 0 ? normalized(-c) : normalized(c);
      if (std::ranges::all_of(around, [&](const Vec3& e) { return dot(g, e) >= -kAngleRounding; }))
        span[spanning++] = g;
      if (spanning > 0 && dot(span[spanning - 1], outward) < kAngleRounding) return kNoWall;
    }
  const std::span<const Vec3> rays = std::span(span).first(spanning);
  if (rays.empty()) return 0;
  std::array<Vec3, 2> farthest{rays[0], rays[0]};
  double least = 1, beside = 0;
  for (const Vec3& g : rays) {
    double nearest = kNoWall;
    for (const Vec3& n : faces) nearest = std::min(nearest, angle(g, n));
    beside = std::max(beside, nearest);
    for (const Vec3& h : rays)
      if (dot(g, h) < least) {
        least = dot(g, h);
        farthest = {g, h};
      }
  }
  const Vec3 middle = normalized(farthest[0] + farthest[1]);
  double cap = 0;
  for (const Vec3& g : rays) cap = std::max(cap, angle(middle, g));
  return cap + beside;
}

std::array<Corners, 4> quarters_of(const Corners& at) {
  Corners middle;
  for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (at[k] + at[(k + 1) % 3]);
  return {
      {{at[0], middle[0], middle[2]}, {at[1], middle[1], middle[0]}, {at[2], middle[2], middle[1]}, middle}};
}

// Whether the triangle is outside of the ball.
bool beyond(const Corners& at, const Ball& ball) {
  return norm(closest_on_triangle(ball.centre, at) - ball.centre) > ball.radius;
}

// Finds a bound on first use. `find` returns the same in all threads, and not 0.
template <class Find>
double known_or(std::atomic<double>& bound, const Find& find) {
  double value = bound.load(std::memory_order_relaxed);
  if (value == 0) bound.store(value = find(), std::memory_order_relaxed);
  return value;
}

}  // namespace

WallThickness::WallThickness(const sites::SitesData& solid, const inside::InsideTest& inside)
    : solid_(&solid),
      inside_(&inside),
      count_(solid.mesh.triangles.size()),
      node_count_(solid.tree.nodes.size()),
      bounds_(std::make_unique<Bound[]>(count_)),
      nodes_(std::make_unique<Bound[]>(node_count_)),
      parts_(std::make_unique<std::atomic<Bounds*>[]>(count_)) {}

WallThickness::~WallThickness() {
  for (std::size_t face = 0; face < count_; ++face) delete parts_[face].load();
}

void WallThickness::forget() {
  for (std::size_t node = 0; node < node_count_; ++node) nodes_[node] = 0;
  for (std::size_t face = 0; face < count_; ++face) {
    bounds_[face] = 0;
    if (Bounds* parts = parts_[face].load())
      for (Bound& bound : *parts) bound = 0;
  }
}

double WallThickness::of_face(std::uint32_t face) const {
  return known_or(bounds_[face], [&] { return find(face, corners_of(solid_->mesh, face)); });
}

double WallThickness::of_subtree(tree::Subtree subtree) const {
  return known_or(nodes_[subtree.root], [&] {
    const tree::AabbTree::Node& node = solid_->tree.nodes[subtree.root];
    double most = 0;
    if (!node.leaf()) {
      most = of_subtree({subtree.root + 1, node.right});
      if (most < kNoWall) most = std::max(most, of_subtree({node.right, subtree.end}));
      return most;
    }
    for (const std::uint32_t face : solid_->tree.items_of(subtree.root))
      if (most < kNoWall) most = std::max(most, of_face(face));
    return most;
  });
}

struct WallThickness::NearBall {
  Ball ball;
  double most;
  Vec3 at;            // in the unit frame
  double reach;       // the radius there
  std::size_t nodes;  // looked at so far
};

bool WallThickness::is_within(const Ball& ball, double most) const {
  const UnitFrame& frame = solid_->frame;
  const double reach = (1 + kSingleRounding) * ball.radius + kUnitDistanceRounding / frame.scale;
  NearBall near{
      {ball.centre, reach}, most, frame.to_unit(ball.centre), frame.scale * reach + kSingleRounding, 0};
  return is_within(tree::whole(solid_->tree), near);
}

bool WallThickness::is_within(tree::Subtree subtree, NearBall& near) const {
  const tree::AabbTree::Node& node = solid_->tree.nodes[subtree.root];
  if (squared_norm(gap(node.box, near.at)) > near.reach * near.reach) return true;
  double to_corner = 0;
  for (int k = 0; k < 3; ++k) {
    const double x = std::max(near.at[k] - node.box.lower[k], node.box.upper[k] - near.at[k]);
    to_corner += x * x;
  }
  const bool covered = to_corner <= near.reach * near.reach;
  near.nodes += covered ? subtree.end - subtree.root : 1;
  if (near.nodes > kMostNodes) return false;
  if (covered && of_subtree(subtree) <= near.most) return true;
  if (node.leaf())
    return std::ranges::all_of(solid_->tree.items_of(subtree.root),
                               [&](std::uint32_t face) { return is_within(face, near); });
  return is_within({subtree.root + 1, node.right}, near) && is_within({node.right, subtree.end}, near);
}

bool WallThickness::is_within(std::uint32_t face, const NearBall& near) const {
  if (of_face(face) <= near.most) return true;
  const Corners at = corners_of(solid_->mesh, face);
  if (beyond(at, near.ball)) return true;
  Bounds& parts = parts_of(face);
  const auto part_is_within = [&](std::size_t part, const Corners& corners) {
    return beyond(corners, near.ball) ||
           known_or(parts[part], [&] { return find(face, corners); }) <= near.most;
  };
  const std::array<Corners, 4> quarters = quarters_of(at);
  for (std::size_t i = 0; i < 4; ++i) {
    if (part_is_within(i, quarters[i])) continue;
    const std::array<Corners, 4> of_quarter = quarters_of(quarters[i]);
    for (std::size_t j = 0; j < 4; ++j)
      if (!part_is_within(4 * i + 4 + j, of_quarter[j])) return false;
  }
  return true;
}

WallThickness::Bounds& WallThickness::parts_of(std::uint32_t face) const {
  Bounds* known = parts_[face].load(std::memory_order_acquire);
  if (known != nullptr) return *known;
  auto made = std::make_unique<Bounds>();
  if (parts_[face].compare_exchange_strong(known, made.get(), std::memory_order_acq_rel))
    return *made.release();
  return *known;
}

double WallThickness::find(std::uint32_t face, const Corners& corners) const {
  const sites::SitesData& solid = *solid_;
  if (solid.sliver[face] != 0 || inside_->sides().of_face(face) != Sides::boundary) return kNoWall;
  double angle = 0;
  for (int k = 0; k < 3; ++k)
    angle = std::max(
        {angle, angle_at_edge(solid, face, k), angle_at_vertex(solid, solid.mesh.triangles[face][k])});
  if (angle > kSteepest) return kNoWall;
  const TouchedTriangle triangle{corners, solid.normals.face[face], angle + kAngleRounding};
  const double in_column = find_in_column(triangle);
  if (in_column < kNoWall) return in_column;
  return bound_of_touching_balls(solid, inside_->sides(), triangle, kThickest / solid.frame.scale);
}

// Let x be the closest point on the face F of a point p inside, b = |p − x|, and θ the angle between the
// outward normal n of F and x − p. If the section of the column of F at a depth L below it is outside, the
// way from p to it along −n leaves the solid, so b ≤ L − b cos θ, and b ≤ L / (1 + cos θ). The column must
// contain p, so that it is wider than F by b sin θ ≤ L tan(θ/2). No point p closest to x is deeper: the point
// of the way to it at the distance L / (1 + cos θ) would be in the column and closest to x, but closer to
// that section.
double WallThickness::find_in_column(const TouchedTriangle& triangle) const {
  const sites::SitesData& solid = *solid_;
  const Corners& corners = triangle.at;
  const Vec3 beside = kWeights[0] * corners[0] + kWeights[1] * corners[1] + kWeights[2] * corners[2] -
                      inside_->sides().offset() * triangle.normal;
  thread_local std::vector<Polygon> faces;
  thread_local std::vector<Levels> taken;
  double wider = 0;
  for (int turn = 0; turn < 3; ++turn) {
    WallColumn column = WallColumn::around(corners, beside, triangle.normal);
    column.enlarge(wider);
    faces.clear();
    const Levels limits{column.lower[0] - kDeepest / solid.frame.scale, 0};
    const Passages passages(solid, column, limits, kMostBelow, faces);
    if (passages.overflow()) return kNoWall;
    taken.clear();
    for (const Polygon& polygon : faces) taken.push_back(passages.levels(polygon));
    std::ranges::sort(taken, {}, &Levels::lower);
    double depth = kNoWall, lo = limits.lower;
    const double least = kLeastGap / solid.frame.scale;
    for (const Levels& t : taken) {
      if (t.lower > 0) break;
      // The winding number inside is 1.
      if (t.lower - lo > least && passages.change(t.lower - 0.5 * least) == -1)
        depth = column.upper[0] - t.lower;
      lo = std::max(lo, t.upper);
    }
    if (depth == kNoWall) return kNoWall;
    const double needed = depth * std::tan(0.5 * triangle.angle);
    if (needed <= wider) return (1 + kDoubleRounding) * depth / (1 + std::cos(triangle.angle));
    wider = 1.01 * needed + kDoubleRounding / solid.frame.scale;
  }
  return kNoWall;
}

}  // namespace sdm::shape

#include "proximity/depth/depth_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/geometry/sweep.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "hierarchy/traverse.h"
#include "proximity/depth/face_distances.h"
#include "proximity/depth/mixed_bound.h"
#include "proximity/shape/node_ball.h"
#include "sites/sites_data.h"

namespace sdm::depth {
namespace {

using inside::Sides;

// Of many open parts, a fraction is evaluated together: neighbours are then among them, and share searches.
constexpr std::size_t kFraction = 64;
constexpr std::uint64_t kFaceStep = std::uint64_t{1} << 32;  // between the places of faces
// Nodes larger than this, relative to the smaller body, are divided at once: hardly any is excluded as a
// whole.
constexpr double kCoarse = 1.0 / 16;
// The cosine between directions that are nearly the same.
constexpr double kSameDirection = 0.9999;
constexpr int kFirstDirections = 3;
// Of so many parts of the boundary that were found last, those that bound a triangle are chosen.
constexpr std::size_t kRecent = 64;
constexpr double kRounding = 1e-9;  // of distances, relative to the size of a body

Vec3 middle(const Box& box) {
  return 0.5 * (box.lo + box.hi);
}

}  // namespace

Depth DepthSearch::find(const Bodies& bodies, const std::array<mesh::Similarity, 2>& to_other,
                        double precision) {
  bodies_ = bodies, to_other_ = to_other, precision_ = precision;
  coarse_ = kCoarse * std::min(diagonal(bodies[0]->box()), diagonal(bodies[1]->box()));
  depth_ = {}, settled_ = 0, sure_ = precision;
  open_.clear(), all_.clear(), known_[0].clear(), known_[1].clear();
  for (int body = 0; body < 2; ++body)
    if (bodies[1 - body]->body().solid()) find_exits(body);
  for (int body = 0; body < 2; ++body)
    if (bodies[1 - body]->body().solid()) add_children({.body = body, .node = 0});
  while (!open_.empty()) {
    take_deepest();
    std::ranges::sort(parts_, {}, [](const Part& part) { return std::pair(part.body, part.place); });
    values_.assign(parts_.size(), {});
    constexpr std::size_t kGrain = 256;
    parallel_for(parts_.size(), kGrain, [&](std::size_t begin, std::size_t end) { evaluate(begin, end); });
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      learn(parts_[i]);
      if (parts_[i].node == kNone && improve(parts_[i], values_[i]))
        exits_[parts_[i].body].add(normalized(*values_[i].boundary - parts_[i].centre));
    }
    for (Part& part : parts_) {
      if (part.node == kNone && part.upper > sure_) tighten(part);
      // The distance to the boundary of a solid that intersects itself has bounds that no division tightens.
      const bool finest =
          part.node == kNone && unit(part.body) * part.radius <= std::max(0.125 * precision, part.gap);
      if (part.upper <= sure_ || finest)
        settle(part.upper);
      else
        divide(part);
    }
  }
  depth_.upper = std::max(depth_.lower, settled_);
  return depth_;
}

// Steps towards a deep point: the point of the body that is farthest from the exit in some direction, and the
// direction from there to the boundary.
void DepthSearch::find_exits(int body) {
  ExitDirections& exits = exits_[body];
  const shape::Body &leaving = bodies_[body]->body(), &other = bodies_[1 - body]->body();
  exits.start(internals(leaving.sites()), internals(other.sites()), to_other_[body]);
  Vec3 direction = normalized(to_other_[body].map(middle(leaving.box())) - middle(other.box()));
  if (direction == Vec3{}) direction = {1, 0, 0};
  for (int i = 0; i < kFirstDirections; ++i) {
    exits.add(direction);
    const Vec3 p = exits.farthest_from_exit();
    parts_.assign(1, {.body = body, .at = {p, p, p}, .centre = p});
    values_.assign(1, {});
    evaluate(0, 1);
    learn(parts_[0]);
    if (!improve(parts_[0], values_[0])) return;
    const Vec3 next = normalized(*values_[0].boundary - p);
    if (dot(next, direction) > kSameDirection) return;
    direction = next;
  }
}

void DepthSearch::learn(const Part& part) {
  if (part.near) known_[part.body].push_back({part.centre, *part.near});
}

// Whether the value at the centre of a part is the largest found so far, with a known point of the boundary.
bool DepthSearch::improve(const Part& part, const Value& value) {
  if (!(unit(part.body) * value.lower > depth_.lower)) return false;
  depth_.lower = unit(part.body) * value.lower;
  depth_.value = unit(part.body) * value.value;
  depth_.points.reset();
  sure_ = depth_.lower + precision_;
  if (!value.boundary) return false;
  const Affine& pose = bodies_[1 - part.body]->pose().map;
  const Vec3 p = pose(part.centre), q = pose(*value.boundary);
  depth_.points = part.body == 0 ? std::array{p, q} : std::array{q, p};
  return true;
}

// Sets parts_ to those with the deepest bounds.
void DepthSearch::take_deepest() {
  parts_.clear();
  while (!open_.empty() && parts_.size() <= open_.size() / kFraction) {
    std::ranges::pop_heap(open_, {}, &Open::upper);
    Part& part = all_[open_.back().part];
    if (part.upper > sure_ && !up_to_date(part)) {
      tighten(part);
      if (part.upper > sure_) {  // others may be deeper now
        open_.back().upper = part.upper;
        std::ranges::push_heap(open_, {}, &Open::upper);
        continue;
      }
    }
    open_.pop_back();
    if (part.upper <= sure_)
      settle(part.upper);
    else if (part.node != kNone && unit(part.body) * part.radius > coarse_)
      divide(Part(part));
    else
      parts_.push_back(part);
  }
}

bool DepthSearch::up_to_date(const Part& part) const {
  return part.exits == exits_[part.body].size() &&
         (part.node != kNone || part.known == known_[part.body].size());
}

// By what has become known since the last time.
void DepthSearch::tighten(Part& part) {
  const ExitDirections& exits = exits_[part.body];
  const double scale = unit(part.body);
  if (part.node != kNone) {
    part.upper = std::min(part.upper, scale * exits.bound(part.centre, part.radius, part.exits));
    part.exits = exits.size();
    return;
  }
  functions_.clear();
  exits.values(part.at, functions_);
  if (part.exits < exits.size())
    part.upper = std::min(part.upper, scale * mixed_bound(functions_, sure_ / scale));
  part.exits = exits.size();
  if (part.upper <= sure_) return;
  const auto known = static_cast<std::uint32_t>(known_[part.body].size());
  if (find_near(part)) {
    add_distances(part);
    part.upper = std::min(part.upper, scale * mixed_bound(functions_, sure_ / scale));
  }
  part.known = known;
}

// Sets near_ to the two parts of the boundary that are known near the centre: its own, or that of the
// triangle that was divided, if it has one, and those of the nearest points among the last ones. Returns
// false if none of them is new.
bool DepthSearch::find_near(const Part& part) {
  const std::vector<Known>& known = known_[part.body];
  std::array<std::size_t, 2> nearest{known.size(), known.size()};
  std::array<double, 2> squared;
  squared.fill(std::numeric_limits<double>::infinity());
  for (std::size_t i = known.size() - std::min(known.size(), kRecent); i < known.size(); ++i) {
    const double s = squared_norm(known[i].from - part.centre);
    if (!(s < squared[1])) continue;
    squared[1] = s, nearest[1] = i;
    if (s < squared[0]) std::swap(squared[0], squared[1]), std::swap(nearest[0], nearest[1]);
  }
  const auto is_new = [&](std::size_t i) { return i < known.size() && i >= part.known; };
  if (!is_new(nearest[0]) && !is_new(nearest[1])) return false;
  if (nearest[1] == known.size()) nearest[1] = nearest[0];
  for (int n = 0; n < 2; ++n) near_[n] = known[nearest[n]].near;
  if (part.near && part.near->face != near_[0].face) near_ = {*part.near, near_[0]};
  return true;
}

// Adds the distances to near_ to functions_.
void DepthSearch::add_distances(Part& part) {
  const std::array<Vec3, 4> points{part.at[0], part.at[1], part.at[2], part.centre};
  std::array<std::array<double, 4>, 2> distances;
  if (near_[0].face != kNone && near_[1].face != kNone)
    distances = face_distances(internals(bodies_[1 - part.body]->body().sites()), points,
                               {near_[0].face, near_[1].face});
  else
    for (int n = 0; n < 2; ++n)
      for (int k = 0; k < 4; ++k) distances[n][k] = norm(points[k] - near_[n].point);
  for (const auto& [a, b, c, centre] : distances) {
    functions_.push_back({a, b, c});
    part.reach = std::min(part.reach, centre);
  }
}

void DepthSearch::add(const Part& part) {
  if (part.upper <= sure_) return settle(part.upper);
  open_.push_back({part.upper, static_cast<std::uint32_t>(all_.size())});
  all_.push_back(part);
  std::ranges::push_heap(open_, {}, &Open::upper);
}

void DepthSearch::divide(const Part& part) {
  if (part.node != kNone) return add_children(part);
  std::array<Vec3, 3> middle;  // of each side
  for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (part.at[k] + part.at[(k + 1) % 3]);
  // The quarters of a triangle follow it, up to the precision of the number.
  const std::uint64_t step = part.step / 4;
  for (int k = 0; k < 3; ++k)
    add_triangle({part.at[k], middle[k], middle[(k + 2) % 3]}, part, part.place + k * step, step);
  add_triangle(middle, part, part.place + 3 * step, step);
}

void DepthSearch::add_triangle(const Corners& at, const Part& parent, std::uint64_t place,
                               std::uint64_t step) {
  const ExitDirections& exits = exits_[parent.body];
  Part part{.body = parent.body,
            .at = at,
            .place = place,
            .step = step,
            .near = parent.near,
            .exits = exits.size()};
  part.upper = std::min(parent.upper, unit(part.body) * exits.bound(at));
  if (part.upper <= sure_) return settle(part.upper);
  part.centre = (1.0 / 3) * (at[0] + at[1] + at[2]);
  for (const Vec3& corner : at) part.radius = std::max(part.radius, norm(corner - part.centre));
  add(part);
}

// The children of a node of the tree, or the faces of a leaf, unless they are beyond the box of the other
// body.
void DepthSearch::add_children(const Part& parent) {
  if (hierarchy::WideTree::is_leaf(parent.node)) return add_faces(parent);
  const int body = parent.body;
  const sites::SitesData& sites = internals(bodies_[body]->body().sites());
  const Box& other = bodies_[1 - body]->body().box();
  const hierarchy::WideTree::Node& wide = sites.wide.nodes[parent.node];
  const ExitDirections::OfChildren by_exits = exits_[body].bound_children(wide);
  for (std::uint32_t i = 0; i < wide.count; ++i) {
    Part part{.body = body, .node = wide.child[i], .place = wide.source[i], .exits = exits_[body].size()};
    part.upper = std::min(parent.upper, unit(body) * by_exits[i]);
    if (part.upper <= sure_) {
      settle(part.upper);
      continue;
    }
    const auto [centre, radius] = shape::ball_of_child(sites, parent.node, i, to_other_[body]);
    part.centre = centre, part.radius = radius;
    if (box_distance({part.centre, part.centre}, other) <= part.radius) add(part);
  }
}

void DepthSearch::add_faces(const Part& parent) {
  const sites::SitesData& sites = internals(bodies_[parent.body]->body().sites());
  const Affine& map = to_other_[parent.body].map;
  const std::uint32_t leaf = hierarchy::WideTree::leaf_number(parent.node);
  for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i) {
    const auto& [a, b, c] = sites.mesh.triangles[sites.regions.owners[i].face];
    const auto& at = sites.mesh.positions;
    const double upper = unit(parent.body) * exits_[parent.body].bound_in_body({at[a], at[b], at[c]});
    if (upper <= sure_)
      settle(upper);
    else
      add_triangle({map(at[a]), map(at[b]), map(at[c])}, parent, i * kFaceStep, kFaceStep);
  }
}

// Parts of one body follow those of the other.
void DepthSearch::evaluate(std::size_t begin, std::size_t end) {
  thread_local std::vector<Vec3> centres;
  while (begin < end) {
    const int body = parts_[begin].body;
    centres.clear();
    for (std::size_t i = begin; i < end && parts_[i].body == body; ++i) centres.push_back(parts_[i].centre);
    const shape::Body& other = bodies_[1 - body]->body();
    const std::span<const Vec3> points = centres;
    bool found = true;
    const auto take = [&](std::size_t first, const sites::ClosestPacket& closest) {
      if (points.size() == 1) found = closest.type[0] != SiteType::none;
      if (!found) return;
      const std::uint32_t inside = other.inside()(points.subspan(first, closest.count), closest);
      for (std::size_t k = 0; k < closest.count; ++k) {
        const std::size_t i = begin + first + k;
        evaluate(parts_[i], values_[i], closest.distance[k], (inside >> k & 1) != 0,
                 closest.get(k, points[first + k]));
      }
    };
    // A face that is known to be near bounds the search, but for rounding far from the origin.
    constexpr double kAnywhere = std::numeric_limits<double>::infinity();
    const double reach =
        points.size() == 1 ? parts_[begin].reach + kRounding * diagonal(other.box()) : kAnywhere;
    cpu::cpu_search(internals(other.sites()), points, reach, std::ref(take));
    if (!found) cpu::cpu_search(internals(other.sites()), points, kAnywhere, std::ref(take));
    begin += centres.size();
  }
}

void DepthSearch::evaluate(Part& part, Value& value, double distance, bool inside,
                           const ClosestPoint& closest) const {
  const shape::Body& other = bodies_[1 - part.body]->body();
  const sites::SitesData& sites = internals(other.sites());
  const Vec3& c = part.centre;
  if (!inside) {
    part.upper = std::min(part.upper, unit(part.body) * bound_outside(part, distance));
    return;
  }
  std::optional<BoundaryPart> nearest;
  const Sides sides = other.inside().sides().of_site(closest.type, closest.site);
  if (sides == Sides::boundary || sides == Sides::reversed)
    nearest = {sites.face_of(closest.type, closest.site), closest.point};
  else if (other.inside().at_boundary(c, closest))
    nearest = {kNone, closest.point};
  value = {distance, distance, closest.point};
  double most = distance;
  if (!nearest) {
    other.require_boundary();
    const inside::SolidBoundary::Closest found = other.boundary().closest(c);
    value = {found.lower, found.point ? found.upper : found.lower, found.point};
    most = found.upper;
    part.gap = unit(part.body) * (found.upper - found.lower);
    if (found.point) nearest = {kNone, *found.point};
  }
  most += part.radius;
  if (nearest) part.near = nearest;
  part.upper = std::min(part.upper, unit(part.body) * most);
}

// Of a part whose centre is outside, by this distance. The way in the triangle from c to a point p that is
// inside passes through some face, at x, so b(p) ≤ |p − x|. As c and p are on different sides of its plane,
// |p − x| is the part of |p − c| that is beyond the plane. A triangle that no face intersects has no point
// inside.
double DepthSearch::bound_outside(const Part& part, double distance) const {
  const double most =
      part.radius - distance;  // the way is at least as long before x as the surface is far from c
  if (part.node != kNone || unit(part.body) * most <= sure_) return most;
  const sites::SitesData& sites = internals(bodies_[1 - part.body]->body().sites());
  Box box;
  for (const Vec3& p : part.at) extend(box, sites.frame.to_unit(p));
  const hierarchy::FloatBox around = hierarchy::FloatBox::around(box);
  const double rounding = 1e-12 / sites.frame.scale;
  double bound = 0;
  const auto near = [&](hierarchy::Subtree subtree) {
    return bound < most && squared_norm(gap(sites.tree.box(subtree.root), around)) == 0;
  };
  hierarchy::traverse(sites.tree, hierarchy::whole(sites.tree), near, [&](std::uint32_t leaf) {
    for (const std::uint32_t face : sites.tree.items_of(leaf)) {
      const auto& [i, j, k] = sites.mesh.triangles[face];
      const Corners corners{sites.mesh.positions[i], sites.mesh.positions[j], sites.mesh.positions[k]};
      if (!triangles_intersect(part.at, corners)) continue;
      if (sites.sliver[face]) bound = most;
      const Vec3& n = sites.normals.face[face];
      const double height = dot(n, part.centre - corners[0]), side = height < 0 ? -1 : 1;
      double beyond = 0;
      for (const Vec3& p : part.at) beyond = std::max(beyond, -side * dot(n, p - corners[0]));
      if (beyond > rounding)
        bound = std::max(bound, part.radius * beyond / (beyond + side * height) + rounding);
    }
  });
  return std::min(most, bound);
}

}  // namespace sdm::depth

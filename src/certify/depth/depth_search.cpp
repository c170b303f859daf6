#include "certify/depth/depth_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "certify/depth/face_distances.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "geometry/sweep.h"
#include "geometry/vec.h"
#include "query/shape/node_ball.h"
#include "search/mixed_bound.h"
#include "sites/sites_data.h"
#include "tree/traverse.h"

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
constexpr std::size_t kRecent = 32;
// So many parts of the boundary are found for a triangle before it is divided.
constexpr std::uint32_t kMostCuts = 4;
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
  open_.clear(), all_.clear(), known_[0].clear(), known_[1].clear(), nears_.clear();
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
      learn(parts_[i], values_[i]);
      if (parts_[i].node == kNone && improve(parts_[i], values_[i]))
        exits_[parts_[i].body].add(normalized(*values_[i].boundary - parts_[i].centre), values_[i].boundary);
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Part& part = parts_[i];
      const bool by_cut = part.upper > sure_ && cut(part, values_[i]);
      if (part.node == kNone && part.upper > sure_) {
        for (std::size_t n = 0; n < values_[i].nears; ++n) add_near(part, values_[i].near[n]);
        tighten(part);
      }
      // The distance to the boundary of a solid that intersects itself has bounds that no division tightens.
      const bool finest =
          part.node == kNone && unit(part.body) * part.radius <= std::max(0.125 * precision, part.gap);
      if (part.upper <= sure_ || finest)
        settle(part.upper);
      else if (by_cut)
        add(part);
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
  std::optional<Vec3> far;
  for (int i = 0; i < kFirstDirections; ++i) {
    exits.add(direction, far);
    const Vec3 p = exits.farthest_from_exit();
    parts_.assign(1, {.body = body, .at = {p, p, p}, .centre = p, .weights = {1, 0, 0}});
    values_.assign(1, {});
    evaluate(0, 1);
    learn(parts_[0], values_[0]);
    if (!improve(parts_[0], values_[0])) return;
    const Vec3 next = normalized(*values_[0].boundary - p);
    if (dot(next, direction) > kSameDirection) return;
    direction = next, far = values_[0].boundary;
  }
}

void DepthSearch::learn(const Part& part, const Value& value) {
  for (std::size_t n = 0; n < value.nears; ++n)
    if (value.near[n].boundary.clear == 0) known_[part.body].push_back({part.centre, value.near[n].boundary});
}

// Whether the part of the boundary that was found excludes the point for which it was found, even though its
// distance is taken to be linear in the triangle. If not, the triangle is too large for that.
bool DepthSearch::cut(const Part& part, const Value& value) const {
  if (part.node != kNone || value.nears == 0 || part.measured > kMostCuts) return false;
  const CornerValues& d = value.near[0].distance;
  const CornerValues& w = part.weights;
  return unit(part.body) * (w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) <= sure_;
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
         (part.node != kNone || (!part.stale && part.known == known_[part.body].size()));
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
  const bool by_known = find_near(part);
  if (by_known || part.exits < exits.size() || part.stale) {
    functions_.clear();
    exits.values(part.at, functions_);
    for (const Near& n : near(part)) functions_.push_back(n.distance);
    if (by_known) add_distances(part);
    const search::MixedBound mixed = search::mixed_bound(functions_, sure_ / scale);
    part.upper = std::min(part.upper, scale * mixed.value);
    part.reach = mixed.value;
    if (part.upper > sure_) place(part, mixed.weights);
  }
  part.exits = exits.size(), part.stale = false;
  part.known = static_cast<std::uint32_t>(known_[part.body].size());
}

// Sets where a triangle is measured.
void DepthSearch::place(Part& part, const CornerValues& weights) const {
  part.weights = weights;
  part.centre = weights[0] * part.at[0] + weights[1] * part.at[1] + weights[2] * part.at[2];
  part.radius = 0;
  for (const Vec3& corner : part.at) part.radius = std::max(part.radius, norm(corner - part.centre));
}

// Sets near_ to the parts of the boundary that are known for the two points nearest to the centre, of the
// last ones. Returns false if none of them is new.
bool DepthSearch::find_near(const Part& part) {
  const std::vector<Known>& known = known_[part.body];
  std::array<std::size_t, 2> nearest{known.size(), known.size()};
  const auto has_near = [&](std::uint32_t face) {
    return std::ranges::any_of(near(part), [&](const Near& n) { return n.boundary.face == face; });
  };
  std::array<double, 2> squared;
  squared.fill(std::numeric_limits<double>::infinity());
  for (std::size_t i = known.size() - std::min(known.size(), kRecent); i < known.size(); ++i) {
    const double s = squared_norm(known[i].from - part.centre);
    if (!(s < squared[1]) || (known[i].near.face != kNone && has_near(known[i].near.face))) continue;
    squared[1] = s, nearest[1] = i;
    if (s < squared[0]) std::swap(squared[0], squared[1]), std::swap(nearest[0], nearest[1]);
  }
  const auto is_new = [&](std::size_t i) { return i < known.size() && i >= part.known; };
  if (!is_new(nearest[0]) && !is_new(nearest[1])) return false;
  if (nearest[1] == known.size()) nearest[1] = nearest[0];
  for (int n = 0; n < 2; ++n) near_[n] = known[nearest[n]].near;
  return true;
}

// The distances of up to four points to a part of the boundary.
std::array<double, 4> DepthSearch::distances(const std::array<Vec3, 4>& points, int body,
                                             const BoundaryPart& boundary) const {
  if (boundary.face != kNone)
    return face_distances(internals(bodies_[1 - body]->body().sites()), points,
                          {boundary.face, boundary.face})[0];
  std::array<double, 4> result;
  for (int k = 0; k < 4; ++k) result[k] = norm(points[k] - boundary.point) - boundary.clear;
  return result;
}

// Adds the distances to near_ to functions_.
void DepthSearch::add_distances(const Part& part) {
  const std::array<Vec3, 4> points{part.at[0], part.at[1], part.at[2], part.at[0]};
  std::array<std::array<double, 4>, 2> found;
  if (near_[0].face != kNone && near_[1].face != kNone)
    found = face_distances(internals(bodies_[1 - part.body]->body().sites()), points,
                           {near_[0].face, near_[1].face});
  else
    for (int n = 0; n < 2; ++n) found[n] = distances(points, part.body, near_[n]);
  for (const auto& [a, b, c, unused] : found) functions_.push_back({a, b, c});
}

DepthSearch::Near DepthSearch::near_at(const Part& part, const BoundaryPart& boundary) const {
  const auto& [a, b, c] = part.at;
  const std::array<double, 4> d = distances({a, b, c, a}, part.body, boundary);
  return {boundary, {d[0], d[1], d[2]}};
}

// At the end of nears_. The last ones are kept.
void DepthSearch::add_near(Part& part, const Near& near) {
  if (part.near + part.nears != nears_.size()) {
    const auto first = static_cast<std::uint32_t>(nears_.size());
    for (std::uint32_t n = 0; n < part.nears; ++n) nears_.push_back(Near(nears_[part.near + n]));
    part.near = first;
  }
  nears_.push_back(near);
  part.nears < kMostNear ? ++part.nears : ++part.near;
  part.stale = true;
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
  const auto quarter = [&](int n, const Corners& at) {
    return Part{.body = part.body, .at = at, .place = part.place + n * step, .step = step};
  };
  std::array<Part, 4> quarters;
  for (int k = 0; k < 3; ++k) quarters[k] = quarter(k, {part.at[k], middle[k], middle[(k + 2) % 3]});
  quarters[3] = quarter(3, middle);
  std::array<std::array<Near, kMostNear>, 4> quarter_near;
  for (std::uint32_t i = 0; i < part.nears; ++i) {
    const Near n = nears_[part.near + i];
    const std::array<double, 4> m =
        distances({middle[0], middle[1], middle[2], middle[0]}, part.body, n.boundary);
    quarter_near[3][i] = {n.boundary, {m[0], m[1], m[2]}};
    for (int k = 0; k < 3; ++k) quarter_near[k][i] = {n.boundary, {n.distance[k], m[k], m[(k + 2) % 3]}};
  }
  for (int k = 0; k < 4; ++k)
    for (std::uint32_t i = 0; i < part.nears; ++i) add_near(quarters[k], quarter_near[k][i]);
  for (Part& q : quarters) add_triangle(q, part);
}

void DepthSearch::add_triangle(Part part, const Part& parent) {
  const ExitDirections& exits = exits_[parent.body];
  part.upper = std::min(parent.upper, unit(part.body) * exits.bound(part.at));
  if (part.upper <= sure_) return settle(part.upper);
  place(part, {1.0 / 3, 1.0 / 3, 1.0 / 3});
  add(part);
}

// The children of a node of the tree, or the faces of a leaf, unless they are beyond the box of the other
// body.
void DepthSearch::add_children(const Part& parent) {
  if (tree::WideTree::is_leaf(parent.node)) return add_faces(parent);
  const int body = parent.body;
  const sites::SitesData& sites = internals(bodies_[body]->body().sites());
  const Box& other = bodies_[1 - body]->body().box();
  const tree::WideTree::Node& wide = sites.wide.nodes[parent.node];
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
  const std::uint32_t leaf = tree::WideTree::leaf_number(parent.node);
  for (std::uint32_t i = sites.regions.leaves[leaf]; i < sites.regions.leaves[leaf + 1]; ++i) {
    const auto& [a, b, c] = sites.mesh.triangles[sites.regions.owners[i].face];
    const auto& at = sites.mesh.positions;
    const double upper = unit(parent.body) * exits_[parent.body].bound_in_body({at[a], at[b], at[c]});
    if (upper <= sure_)
      settle(upper);
    else
      add_triangle({.body = parent.body,
                    .at = {map(at[a]), map(at[b]), map(at[c])},
                    .place = i * kFaceStep,
                    .step = kFaceStep},
                   parent);
  }
}

// Parts of one body follow those of the other.
void DepthSearch::evaluate(std::size_t begin, std::size_t end) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  if (end == begin + 1) return evaluate(parts_[begin], values_[begin]);
  thread_local std::vector<Vec3> centres;
  while (begin < end) {
    const int body = parts_[begin].body;
    centres.clear();
    for (std::size_t i = begin; i < end && parts_[i].body == body; ++i) centres.push_back(parts_[i].centre);
    const shape::Body& other = bodies_[1 - body]->body();
    const std::span<const Vec3> points = centres;
    const auto take = [&](std::size_t first, const sites::ClosestPacket& closest) {
      const std::uint32_t inside = other.inside()(points.subspan(first, closest.count), closest);
      for (std::size_t k = 0; k < closest.count; ++k) {
        const std::size_t i = begin + first + k;
        evaluate(parts_[i], values_[i], closest.distance[k], (inside >> k & 1) != 0,
                 closest.get(k, points[first + k]));
      }
    };
    cpu::cpu_search(internals(other.sites()), points, kAnywhere, std::ref(take));
    begin += centres.size();
  }
}

void DepthSearch::evaluate(Part& part, Value& value) const {
  const shape::Body& other = bodies_[1 - part.body]->body();
  const sites::SitesData& sites = internals(other.sites());
  // If the centre is inside, its bound is one on the search, but for rounding far from the origin.
  ClosestPoint closest = cpu::cpu_closest(sites, part.centre, part.reach + kRounding * diagonal(other.box()));
  if (closest.type == SiteType::none)
    closest = cpu::cpu_closest(sites, part.centre, std::numeric_limits<double>::infinity());
  evaluate(part, value, closest.distance, other.inside()(part.centre, closest), closest);
}

void DepthSearch::evaluate(Part& part, Value& value, double distance, bool inside,
                           const ClosestPoint& closest) const {
  const shape::Body& other = bodies_[1 - part.body]->body();
  const sites::SitesData& sites = internals(other.sites());
  const Vec3& c = part.centre;
  ++part.measured;
  const auto found_face = [&]() -> std::optional<BoundaryPart> {
    const Sides sides = other.inside().sides().of_site(closest.type, closest.site);
    if (sides != Sides::boundary && sides != Sides::reversed) return {};
    return BoundaryPart{.face = sites.face_of(closest.type, closest.site), .point = closest.point};
  };
  const auto keep = [&](const BoundaryPart& boundary) {
    value.near[value.nears++] = part.node == kNone ? near_at(part, boundary) : Near{boundary, {}};
  };
  if (!inside) {
    part.upper = std::min(part.upper, unit(part.body) * (part.radius - distance));
    if (part.node != kNone || part.upper <= sure_) return;
    if (const std::optional<BoundaryPart> face = found_face()) keep(*face);
    keep({.point = c, .clear = distance});
    part.upper = std::min(part.upper, unit(part.body) * bound_outside(part, value, distance));
    return;
  }
  value.lower = value.value = distance, value.boundary = closest.point;
  double most = distance;
  std::optional<BoundaryPart> found = found_face();
  if (!found && other.inside().at_boundary(c, closest)) {
    found = {.point = closest.point};
  } else if (!found) {
    other.require_boundary();
    const inside::SolidBoundary::Closest b = other.boundary().closest(c);
    value.lower = b.lower, value.value = b.point ? b.upper : b.lower, value.boundary = b.point;
    most = b.upper;
    part.gap = unit(part.body) * (b.upper - b.lower);
    if (b.point) found = {.point = *b.point};
  }
  part.upper = std::min(part.upper, unit(part.body) * (most + part.radius));
  if (found) keep(*found);
}

// Of a triangle whose centre is outside, by this distance, and not bounded by that alone. The way in the
// triangle from c to a point p that is inside passes through some face, at x, so b(p) ≤ |p − x|. As c and p
// are on different sides of its plane, |p − x| is the part of |p − c| that is beyond the plane. A triangle
// that no face intersects has no point inside.
double DepthSearch::bound_outside(const Part& part, const Value& value, double distance) const {
  std::array<CornerValues, kMostNear + 2> functions;
  std::size_t count = 0;
  for (const Near& n : near(part)) functions[count++] = n.distance;
  for (std::size_t n = 0; n < value.nears; ++n) functions[count++] = value.near[n].distance;
  const double enough = sure_ / unit(part.body);
  const double mixed = search::mixed_bound(std::span(functions).first(count), enough).value;
  if (mixed <= enough) return mixed;

  // The way is at least as long before x as the surface is far from c.
  const double most = std::min(mixed, part.radius - distance);
  const sites::SitesData& sites = internals(bodies_[1 - part.body]->body().sites());
  Box box;
  for (const Vec3& p : part.at) extend(box, sites.frame.to_unit(p));
  const tree::FloatBox around = tree::FloatBox::around(box);
  const double rounding = 1e-12 / sites.frame.scale;
  double bound = 0;
  const auto near = [&](tree::Subtree subtree) {
    return bound < most && squared_norm(gap(sites.tree.box(subtree.root), around)) == 0;
  };
  tree::traverse(sites.tree, tree::whole(sites.tree), near, [&](std::uint32_t leaf) {
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

#include "query/self_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/vec.h"
#include "engine/closest_on_face.h"
#include "query/triangle_pair.h"

namespace sdm {

struct SelfSearch::Scratch {
  struct Entry {
    std::uint32_t child;  ///< of a wide node
    double squared;       ///< distance of its box in the unit frame
  };
  std::vector<Entry> stack;
  std::vector<std::uint8_t> excluded;  ///< of each face; all 0 between searches

  static Scratch& of_this_thread() {
    thread_local Scratch scratch;
    return scratch;
  }
};

namespace {

constexpr double kAbove = 1 + 1e-12;  // by more than squares are rounded: equals must be compared

// Squared distances of a box to those of a node's children; both in the unit frame.
void find_distances(const WideTree::Node& node, const Box& box, double (&squared)[WideTree::kWidth]) {
  for (int i = 0; i < WideTree::kWidth; ++i) squared[i] = 0;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < WideTree::kWidth; ++i) {
      const double gap = std::max({node.lo[k][i] - box.hi[k], box.lo[k] - node.hi[k][i], 0.0});
      squared[i] += gap * gap;
    }
}

Corners corners(const Mesh& mesh, std::uint32_t face) {
  const Triangle& t = mesh.triangles[face];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

}  // namespace

bool FacePair::before(const FacePair& other) const {
  return std::tie(distance, face1, face2) < std::tie(other.distance, other.face1, other.face2);
}

SelfSearch::SelfSearch(const Sites::Impl& sites, const Exclusion& exclusion)
    : sites_(sites), exclusion_(exclusion), scratch_(Scratch::of_this_thread()) {
  if (scratch_.excluded.size() < exclusion.faces()) scratch_.excluded.resize(exclusion.faces());
}

SelfSearch::~SelfSearch() {
  start_from(kNone);
}

void SelfSearch::start_from(std::uint32_t face) {
  const auto mark = [&](std::uint8_t value) {
    if (face_ == kNone) return;
    for (const std::uint32_t f : exclusion_.of(face_)) scratch_.excluded[f] = value;
  };
  mark(0);
  face_ = face;
  mark(1);
}

// Calls visit(face) for the faces in leaves whose boxes are no farther from `box` than `limit`, which may
// shrink meanwhile; the nearer leaves first, as far as depth first allows. Excluded faces are passed over.
template <class Visit>
void SelfSearch::visit_near(const Box& box, double& limit, const Visit& visit) const {
  const UnitFrame& frame = sites_.frame;
  const Box unit{frame.to_unit(box.lo), frame.to_unit(box.hi)};
  const auto too_far = [&](double squared) {
    // Coordinates of the unit frame are rounded by 1e-16.
    const double most = (1 + 1e-9) * frame.scale * limit + 1e-15;
    return squared > most * most;
  };
  auto& stack = scratch_.stack;
  stack.assign(1, {0, 0});
  while (!stack.empty()) {
    const auto [child, squared] = stack.back();
    stack.pop_back();
    if (too_far(squared)) continue;
    if ((child & WideTree::kLeafBit) != 0) {
      const std::uint32_t leaf = child & ~WideTree::kLeafBit;
      for (std::uint32_t i = sites_.regions.leaves[leaf]; i < sites_.regions.leaves[leaf + 1]; ++i)
        if (const std::uint32_t face = sites_.tree.items[i]; scratch_.excluded[face] == 0) visit(face);
      continue;
    }
    const WideTree::Node& node = sites_.wide.nodes[child];
    double distances[WideTree::kWidth];
    find_distances(node, unit, distances);
    const auto base = static_cast<std::ptrdiff_t>(stack.size());
    for (std::uint32_t i = 0; i < node.count; ++i) {
      if (too_far(distances[i])) continue;
      auto at = stack.end();  // the nearest on top
      while (at != stack.begin() + base && (at - 1)->squared < distances[i]) --at;
      stack.insert(at, {node.child[i], distances[i]});
    }
  }
}

ClosestPoint SelfSearch::closest_to(const Vec3& q, double max_distance, std::uint32_t guess) const {
  ClosestPoint best;
  double limit = max_distance;
  const auto visit = [&](std::uint32_t face) {
    if (squared_box_distance(corners(sites_.mesh, face), {q, q, q}) > kAbove * limit * limit) return;
    const ClosestPoint c = closest_on_face(sites_, face, q);
    if (c.distance < best.distance && c.distance <= limit) best = c, limit = c.distance;
  };
  if (guess != kNone && scratch_.excluded[guess] == 0) visit(guess);
  visit_near({q, q}, limit, visit);
  return best;
}

FacePair SelfSearch::nearest(double max_distance) const {
  FacePair best;
  double limit = max_distance;
  const Corners own = corners(sites_.mesh, face_);
  Box box;
  for (const Vec3& p : own) extend(box, p);
  visit_near(box, limit, [&](std::uint32_t other) {
    const Corners others = corners(sites_.mesh, other);
    if (squared_box_distance(own, others) > kAbove * limit * limit) return;
    const bool first = face_ < other;  // either way the same roundings
    const PointPair c = first ? closest_or_common(own, others) : closest_or_common(others, own);
    const FacePair pair{std::sqrt(c.squared), std::min(face_, other), std::max(face_, other), c.point1,
                        c.point2};
    if (pair.distance <= limit && pair.before(best)) best = pair, limit = pair.distance;
  });
  return best;
}

}  // namespace sdm

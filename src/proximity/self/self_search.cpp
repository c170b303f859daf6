#include "proximity/self/self_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "hierarchy/traverse_wide.h"
#include "sites/closest_on_face.h"

namespace sdm::self {

struct SelfSearch::Scratch {
  std::vector<hierarchy::OpenChild<double>> stack;
  std::vector<std::pair<double, std::uint32_t>> candidates;  ///< with their distance from the ball's centre
  std::vector<std::uint8_t> excluded;                        ///< for each face; all 0 between searches

  static Scratch& of_this_thread() {
    thread_local Scratch scratch;
    return scratch;
  }
};

namespace {

constexpr double kAbove = 1 + 1e-12;  // larger than the rounding error of squares: ties must be compared

Corners corners(const Mesh& mesh, std::uint32_t face) {
  const Triangle& t = mesh.triangles[face];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

}  // namespace

bool FacePair::before(const FacePair& other) const {
  return std::tie(distance, face1, face2) < std::tie(other.distance, other.face1, other.face2);
}

SelfSearch::SelfSearch(const sites::SitesData& sites, const Exclusion& exclusion)
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

// Calls visit(face) for the faces in leaves whose boxes are within `limit` of `box`; `limit` may shrink
// meanwhile. Depth first, the nearest child first. Skips excluded faces.
template <class Visit>
void SelfSearch::visit_near(const Box& box, double& limit, const Visit& visit) const {
  const UnitFrame& frame = sites_.frame;
  const Box unit{frame.to_unit(box.lo), frame.to_unit(box.hi)};
  const auto within = [&](double squared) {
    // Coordinates in the unit frame have a rounding error of 1e-16.
    const double most = (1 + 1e-9) * frame.scale * limit + 1e-15;
    return !(squared > most * most);
  };
  hierarchy::traverse_nearest_child_first(
      sites_.wide, scratch_.stack,
      [&](const hierarchy::WideTree::Node& node, double(&squared)[hierarchy::WideTree::kWidth]) {
        squared_distances(node, unit, squared);
        std::uint32_t near = 0;
        for (std::uint32_t i = 0; i < node.count; ++i) near |= (within(squared[i]) ? 1u : 0u) << i;
        return near;
      },
      within,
      [&](std::uint32_t leaf) {
        for (std::uint32_t i = sites_.regions.leaves[leaf]; i < sites_.regions.leaves[leaf + 1]; ++i)
          if (const std::uint32_t face = sites_.tree.items[i]; scratch_.excluded[face] == 0) visit(face);
      });
}

// A bound on the distance from the centre c to a face g that is closest to a point q of the ball: with d_c =
// min d(c, ·), d(c, g) ≤ d(q, g) + r ≤ d_c + 2r.
void SelfSearch::gather(const Vec3& centre, double radius, double max_distance) {
  centre_ = centre, max_distance_ = max_distance;
  auto& candidates = scratch_.candidates;
  candidates.clear();
  double limit = max_distance + radius;
  visit_near({centre, centre}, limit, [&](std::uint32_t face) {
    const double distance = sites::closest_on_face(sites_, face, centre).distance;
    if (distance > limit) return;
    candidates.push_back({distance, face});
    limit = std::min(limit, distance + 2 * radius);
  });
  std::ranges::sort(candidates);
}

ClosestPoint SelfSearch::closest_to(const Vec3& q) const {
  ClosestPoint best;
  double limit = max_distance_;
  const double from_centre = norm(q - centre_);
  for (const auto& [at_centre, face] : scratch_.candidates) {
    if (at_centre - from_centre > limit) break;  // d(q, g) ≥ d(c, g) − |q − c|
    if (squared_box_distance(corners(sites_.mesh, face), {q, q, q}) > kAbove * limit * limit) continue;
    const ClosestPoint c = sites::closest_on_face(sites_, face, q);
    if (c.distance < best.distance && c.distance <= limit) best = c, limit = c.distance;
  }
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
    const bool first = face_ < other;  // the same order, and so the same rounding, from either face
    const PointPair c = first ? closest_or_common(own, others) : closest_or_common(others, own);
    const FacePair pair{std::sqrt(c.squared), std::min(face_, other), std::max(face_, other), c.point1,
                        c.point2};
    if (pair.distance <= limit && pair.before(best)) best = pair, limit = pair.distance;
  });
  return best;
}

}  // namespace sdm::self

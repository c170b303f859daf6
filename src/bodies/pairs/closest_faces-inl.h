// The closest faces found so far, and what follows from them for the search. Included once for each set of
// vector instructions.
#if defined(SDM_PROXIMITY_CLOSEST_FACES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_PROXIMITY_CLOSEST_FACES_INL_H
#undef SDM_PROXIMITY_CLOSEST_FACES_INL_H
#else
#define SDM_PROXIMITY_CLOSEST_FACES_INL_H
#endif

#include <algorithm>
#include <vector>

#include "bodies/pairs/face_lanes-inl.h"
#include "bodies/pairs/pair_search.h"
#include "core/cancellation.h"
#include "geometry/lanes/triangle_pair-inl.h"
#include "geometry/triangle_pair.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

using Candidate = PairWorkspace::Candidate;
using Tie = PairWorkspace::Tie;
using tree::Place;

constexpr double kNoDistance = kInfinity;

// The surfaces of a search, and the maps between their frames.
struct Surfaces {
  const MeshPair& pair;
  const sites::SitesData* sites[2];
  const UnitMaps maps;

  explicit Surfaces(const MeshPair& p) : pair(p), sites{&p.o1, &p.o2}, maps(p) {}

  tree::FloatBox box_of(const Place& place, int side) const {
    return tree::box_of(sites[side]->tree, sites[side]->wide, place);
  }
  // A lower bound on the distance of things that have these extents along a direction.
  HWY_INLINE float extent(const Direction& direction, float along1, float along2) const {
    return maps.unit[0] * (along1 + along2 + direction.offset - maps.to[0].error);
  }
  // A lower bound on distances in O1's unit frame, in the units of the meshes.
  HWY_INLINE Vec in_units(Vec distance) const {
    const Lanes d;
    return hn::Mul(hn::Set(d, maps.unit[0]), hn::Sub(distance, hn::Set(d, maps.to[0].error)));
  }
};

// Collects pairs of faces that may be closest, and compares many of them at a time.
class ClosestFaces {
 public:
  ClosestFaces(const Surfaces& surfaces, double bound, PairWorkspace& workspace)
      : s_(surfaces), w_(workspace), bound_(bound) {
    w_.candidates.clear();
    w_.ties.clear();
    limit_ = s_.maps.round_up(limit_in_double());
  }

  // Any direction bounds distances from below, and that from one body to the other bounds most.
  void look_ahead() {
    Vec3 middle[2];
    for (int side = 0; side < 2; ++side) {
      const tree::FloatBox& box = s_.sites[side]->tree.box(0);
      for (int k = 0; k < 3; ++k) middle[side][k] = 0.5 * (double{box.lower[k]} + box.upper[k]);
      middle[side] = s_.sites[side]->frame.origin + (1 / s_.sites[side]->frame.scale) * middle[side];
    }
    direction_ = s_.maps.direction(s_.pair.pose(middle[1]) - middle[0]);
  }

  // Faces that bound the search from the start.
  void begin_with(const FacePair& faces) {
    restrict(std::sqrt(points_of(faces).squared));
    direction_ = s_.maps.direction(points_.point2 - points_.point1);
  }

  [[nodiscard]] float limit() const { return limit_; }
  [[nodiscard]] const Direction& direction() const { return direction_; }
  [[nodiscard]] bool bounded() const { return bound_ < kNoDistance; }
  [[nodiscard]] bool found() const { return least_ < kNoDistance; }
  // Many at a time, unless the limit is still loose.
  [[nodiscard]] bool due() const { return !found() || w_.candidates.size() >= TrianglePairs::kLanes; }

  void add(const Candidate& candidate) { w_.candidates.push_back(candidate); }
  FacePair faces_of(const Candidate& candidate) const {
    return {s_.sites[0]->tree.items[candidate.owner1], s_.sites[1]->tree.items[candidate.owner2]};
  }

  // Nearest first, which excludes most of the others if there are many.
  void compare() {
    std::vector<Candidate>& all = w_.candidates;
    if (all.size() > TrianglePairs::kLanes) std::ranges::sort(all, {}, &Candidate::least);
    Poll due(256);
    for (size_t next = 0; next < all.size() && !(all[next].least > limit_); due()) next = compare_some(next);
    all.clear();
  }

  // The result depends on which pairs are tied, not on the order in which they were found.
  Separation result() {
    FacePair first = kNoFaces;
    double least = kNoDistance;
    for (const Tie& tie : w_.ties) least = std::min(least, tie.distance);
    for (const Tie& tie : w_.ties)
      if (tie.distance <= least + s_.maps.rounding()) first = std::min(first, tie.faces);
    if (first == kNoFaces) return {};
    const PointPair& points = points_of(first);
    const double distance = std::sqrt(points.squared);
    if (distance > bound_) return {};
    return {distance, false, points.point1, points.point2, first[0], first[1]};
  }

 private:
  // Compares as many candidates as there are lanes, from `next` on. Returns the first one after them.
  HWY_NOINLINE size_t compare_some(size_t next) {
    const double most = limit_in_double();
    // Most pairs are excluded by their boxes in double precision if the meshes have details too fine for
    // single precision, else none.
    constexpr float kFine = 1e-3f;
    const bool fine = s_.maps.unit[0] * s_.maps.to[0].error > kFine * limit_;
    FacePair faces[TrianglePairs::kLanes];
    size_t count = 0;
    for (; next < w_.candidates.size() && count < TrianglePairs::kLanes; ++next) {
      const FacePair pair = faces_of(w_.candidates[next]);
      const Corners a = s_.pair.face1(pair[0]), b = s_.pair.face2(pair[1]);
      if (fine && squared_box_distance(a, b) > most * most) continue;
      pairs_.set(count, a, b);
      faces[count++] = pair;
    }
    double squared[TrianglePairs::kLanes];
    pairs_.squared_distances(count, squared);
    if (count == 0) return next;
    const size_t least = static_cast<size_t>(std::min_element(squared, squared + count) - squared);
    if (const double distance = std::sqrt(squared[least]); distance < least_) {
      const bool closer = distance < least_ - s_.maps.rounding();
      restrict(distance);
      if (closer) {
        std::erase_if(w_.ties, [&](const Tie& tie) { return tie.distance > limit_in_double(); });
        points_of(faces[least]);
        direction_ = s_.maps.direction(points_.point2 - points_.point1);
      }
    }
    for (size_t i = 0; i < count; ++i)
      if (const double distance = std::sqrt(squared[i]); distance <= limit_in_double())
        w_.ties.push_back({distance, faces[i]});
    return next;
  }

  // The closest points of two faces; those of the last ones are kept.
  const PointPair& points_of(const FacePair& faces) {
    if (faces != faces_of_points_) points_ = closest_points(s_.pair.face1(faces[0]), s_.pair.face2(faces[1]));
    faces_of_points_ = faces;
    return points_;
  }

  // Faces at larger distances than this are not closest.
  double limit_in_double() const { return std::min(least_, bound_) + 2 * s_.maps.rounding(); }
  void restrict(double distance) {
    least_ = std::min(least_, distance);
    limit_ = s_.maps.round_up(limit_in_double());
  }

  const Surfaces& s_;
  PairWorkspace& w_;
  const double bound_;
  double least_ = kNoDistance;  // the smallest distance of two faces that is known
  FacePair faces_of_points_ = kNoFaces;
  PointPair points_{};
  float limit_;          // pairs farther than this are excluded
  Direction direction_;  // from the closest point of O1 found so far to that of O2
  TrianglePairs pairs_;
};

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

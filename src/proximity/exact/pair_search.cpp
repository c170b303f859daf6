#include "proximity/exact/pair_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "proximity/exact/pair_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "proximity/exact/face_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::exact::HWY_NAMESPACE {

using Entry = PairWorkspace::Entry;

// `separate`: searches for the closest faces, otherwise for any that intersect.
template <bool separate>
class PairSearch {
 public:
  PairSearch(const MeshPair& pair, double bound, PairWorkspace& workspace)
      : pair_(pair), sites_{&pair.o1, &pair.o2}, maps_(pair), w_(workspace) {
    best_.distance = bound;
    limit_ = maps_.round_up(bound);
  }

  Separation run() {
    w_.overlapping.assign(1, {});
    w_.apart.clear();
    Entry entry;
    while (!best_.intersecting && next(entry))
      if (entry.leaves())
        compare_leaves(entry);
      else
        open(entry);
    return best_.face1 == kNone ? Separation{} : best_;
  }

 private:
  // Overlapping pairs must all be visited, unless an intersection is found: depth first, which finds one
  // soon. Disjoint pairs are visited nearest first, so that only those nearer than the closest faces are
  // visited.
  bool next(Entry& entry) {
    if (!w_.overlapping.empty()) {
      entry = w_.overlapping.back();
      w_.overlapping.pop_back();
      return true;
    }
    if (w_.apart.empty() || w_.apart.top().least > limit_) return false;
    entry = w_.apart.pop();
    return true;
  }

  CentredBox box_of(const Entry& entry, int side) const {
    return CentredBox(sites_[side]->tree.box(entry.place[side].source));
  }

  // Pairs the children of the larger node with the other node.
  void open(const Entry& entry) {
    const CentredBox box[2] = {box_of(entry, 0), box_of(entry, 1)};
    const int larger = box[0].size() * maps_.unit[0] < box[1].size() * maps_.unit[1];
    const int side = entry.place[larger].leaf() ? 1 - larger : larger;
    if (side != larger && put_off(entry, box[side])) return;
    const hierarchy::WideTree::Node& node = sites_[side]->wide.nodes[entry.place[side].child];
    const BoxDistances distances(maps_, direction_, side, box[1 - side]);
    alignas(64) float least[kWidth];
    const Lanes d;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) hn::Store(distances(node, i), d, least + i);

    const auto base = static_cast<std::ptrdiff_t>(w_.overlapping.size());
    for (uint32_t i = 0; i < node.count; ++i) {
      if (least[i] > limit_) continue;
      Entry child = entry;
      child.place[side] = {node.child[i], node.source[i]};
      child.least = least[i];
      if (child.leaves() && discs_apart(child)) continue;
      if (least[i] > 0) {
        w_.apart.push(child);
        continue;
      }
      auto at = w_.overlapping.end();  // deepest overlap on top
      while (at != w_.overlapping.begin() + base && (at - 1)->least < child.least) --at;
      w_.overlapping.insert(at, child);
    }
  }

  // The box of a leaf with large faces is a loose bound: against a smaller box, its faces are bounded one by
  // one. Returns whether this pair is finished; otherwise it is opened later.
  bool put_off(Entry entry, const CentredBox& small) {
    const int large = entry.place[0].leaf() ? 0 : 1;
    load_faces(large, entry.place[large].leaf_number());
    const PlacedBox box = large == 1 ? PlacedBox(small) : PlacedBox(small, maps_.to[0]);
    const float least = maps_.unit[0] * (least_distance(faces_[large], box) - maps_.to[0].error);
    if (least > limit_) return true;
    if (!(least > std::max(entry.least, 0.0f))) return false;
    entry.least = least;
    w_.apart.push(entry);
    return true;
  }

  // Whether all faces of the leaves are too far apart in the direction between the closest points found so
  // far.
  bool discs_apart(const Entry& entry) const {
    if (!direction_.known) return false;
    float apart = direction_.offset - maps_.to[0].error;
    for (int side = 0; side < 2; ++side)
      apart += least_along(sites_[side]->regions, entry.place[side].leaf_number(), direction_.along[side]);
    return maps_.unit[0] * apart > limit_;
  }

  void load_faces(int side, uint32_t leaf) {
    if (loaded_[side] == leaf) return;
    loaded_[side] = leaf;
    faces_[side].load(*sites_[side], leaf);
    if (side == 1) faces_[side].move(maps_.to[0]);
    faces_[side].find_normals();
  }

  void compare_leaves(const Entry& entry) {
    if (discs_apart(entry)) return;  // the direction may have improved since the leaves were paired
    for (int side = 0; side < 2; ++side) load_faces(side, entry.place[side].leaf_number());
    const LeafFaces &a = faces_[0], &b = faces_[1];
    Candidate candidates[kWidth * kWidth];
    size_t count = 0;
    const Lanes d;
    for (uint32_t j = 0; j < b.count(); ++j) {
      alignas(64) float least[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
        hn::Store(in_units(face_distances(a, i, b, j, direction_)), d, least + i);
      for (uint32_t i = 0; i < a.count(); ++i) {
        // 0 for all that may intersect: how far below depends on the closest faces found so far.
        candidates[count] = {std::max(least[i], 0.0f), a.first() + i, b.first() + j};
        count += !(least[i] > limit_);
      }
    }
    compare(candidates, count);
  }

  HWY_INLINE Vec in_units(Vec distance) const {
    const Lanes d;
    return hn::Mul(hn::Set(d, maps_.unit[0]), hn::Sub(distance, hn::Set(d, maps_.to[0].error)));
  }

  // Faces by their position in the order of the trees.
  struct Candidate {
    float least;
    uint32_t owner1, owner2;

    /// Of equally near ones, that with the smaller numbers: the order does not depend on which others there
    /// are.
    bool before(const Candidate& other) const {
      return least < other.least ||
             (least == other.least && std::pair(owner1, owner2) < std::pair(other.owner1, other.owner2));
    }
  };

  // Nearest first, which excludes most of the others.
  void compare(Candidate* candidates, size_t count) {
    for (; count > 0 && !best_.intersecting; --count) {
      Candidate* nearest = candidates;
      for (size_t i = 1; i < count; ++i)
        if (candidates[i].before(*nearest)) nearest = candidates + i;
      if (nearest->least > limit_) return;
      compare(*nearest);
      *nearest = candidates[count - 1];
    }
  }

  void compare(const Candidate& candidate) {
    constexpr double kAbove = 1 + 1e-12;  // larger than the rounding error of squares: ties must be compared
    const uint32_t face1 = sites_[0]->tree.items[candidate.owner1],
                   face2 = sites_[1]->tree.items[candidate.owner2];
    const Corners a = pair_.face1(face1), b = pair_.face2(face2);
    // Most pairs end here if the meshes have details too fine for single precision.
    if (squared_box_distance(a, b) > kAbove * best_.distance * best_.distance) return;
    if (!(candidate.least > 0) && triangles_intersect(a, b)) {
      const Vec3 point = common_point(a, b);
      best_ = {0, true, point, point, face1, face2};
      return;
    }
    if constexpr (separate) {
      const PointPair closest = closest_points(a, b);
      const double distance = std::sqrt(closest.squared);
      if (distance > best_.distance || (distance == best_.distance && best_.face1 != kNone &&
                                        !(std::pair(face1, face2) < std::pair(best_.face1, best_.face2))))
        return;
      best_ = {distance, false, closest.point1, closest.point2, face1, face2};
      limit_ = maps_.round_up(distance);
      direction_ = maps_.direction(closest.point2 - closest.point1);
    }
  }

  const MeshPair& pair_;
  const sites::SitesData* sites_[2];
  const UnitMaps maps_;
  PairWorkspace& w_;
  Separation best_;
  float limit_;          // pairs farther than this are excluded
  Direction direction_;  // from the closest point of O1 found so far to that of O2
  LeafFaces faces_[2];
  uint32_t loaded_[2] = {kNone, kNone};  // the leaves they were loaded from
};

Separation FindClosest(const MeshPair& pair, double bound, PairWorkspace& workspace) {
  return PairSearch<true>(pair, bound, workspace).run();
}
Separation FindIntersection(const MeshPair& pair, PairWorkspace& workspace) {
  return PairSearch<false>(pair, 0, workspace).run();
}

}  // namespace sdm::exact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::exact {

HWY_EXPORT(FindClosest);
HWY_EXPORT(FindIntersection);

Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(FindClosest)(pair, bound, workspace);
}
double face_distance(const MeshPair& pair, std::uint32_t face1, std::uint32_t face2) {
  return std::sqrt(closest_points(pair.face1(face1), pair.face2(face2)).squared);
}

Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(FindIntersection)(pair, workspace);
}

}  // namespace sdm::exact
#endif

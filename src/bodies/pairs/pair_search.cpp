#include "bodies/pairs/pair_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/pairs/pair_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "bodies/pairs/caps-inl.h"
#include "bodies/pairs/cylinder_lanes-inl.h"
#include "bodies/pairs/separating_axis.h"
#include "tree/visit_pairs.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

namespace {

// The policy of a search of both trees. `separate`: for the closest faces, otherwise for any that intersect.
//
// Steps that call scalar code are not inlined into the loop of the search: the compiler clears the upper
// halves of vector registers where a function returns, without which the scalar code is slower (collisions of
// small meshes by a fifth).
template <bool separate>
class PairSearch {
 public:
  using Pair = PairWorkspace::Entry;

  PairSearch(const MeshPair& pair, double bound, PairWorkspace& workspace)
      : s_(pair), cylinders_known_(pair.has_cylinders()), w_(workspace), closest_(s_, bound, workspace) {}

  ClosestFaces& closest() { return closest_; }

  // `separate`: the closest faces, or those that intersect, with their points; otherwise faces alone.
  Separation run() {
    w_.overlapping.clear();
    w_.apart.clear();
    // Caps of large meshes are mostly too large as long as there is no bound: trying costs a tenth of the
    // search.
    if (!separate || !closest_.bounded() || !pair_caps()) w_.overlapping.assign(1, {});
    tree::visit_pairs(s_.sites[0]->wide, s_.sites[1]->wide, *this);
    return intersection_.intersecting ? intersection_ : closest_.result();
  }

  // Overlapping pairs must all be visited, unless an intersection is found: depth first, which finds one
  // soon. Disjoint pairs are visited nearest first, so that only those nearer than the closest faces are
  // visited.
  bool next(Pair& pair) {
    if (intersection_.intersecting) return false;
    if (!w_.overlapping.empty()) {
      pair = w_.overlapping.back();
      w_.overlapping.pop_back();
      return true;
    }
    if (!w_.apart.empty() && !(w_.apart.top().least > closest_.limit())) {
      pair = w_.apart.pop();
      return true;
    }
    closest_.compare();
    return false;
  }
  bool enter(const Pair&) const { return true; }

  void leaf(const Pair& pair) {
    compare_leaves(pair);
    if (separate && closest_.due()) closest_.compare();
  }

  // Divides the larger node, unless it is a leaf.
  tree::Division bound(const Pair& pair, float (&least)[kWidth]) {
    const CentredBox box[2] = {CentredBox(s_.box_of(pair.place[0], 0)),
                               CentredBox(s_.box_of(pair.place[1], 1))};
    const int larger = box[0].size() * s_.maps.unit[0] < box[1].size() * s_.maps.unit[1];
    const int side = pair.place[larger].leaf() ? 1 - larger : larger;
    if (side != larger && put_off(pair, larger, box)) return {};
    bound_children(pair, side, box[1 - side], least);
    const tree::WideTree::Node& node = s_.sites[side]->wide.nodes[pair.place[side].child];
    if (side != larger) prefer_crossing(side, node, least);
    overlapping_before_ = static_cast<std::ptrdiff_t>(w_.overlapping.size());
    return {side, children_within(node, least, closest_.limit())};
  }

  void open(Pair& pair, int side, float least) {
    pair.least = least;
    if (pair.leaves() && discs_apart(pair)) return;
    if (least > 0) return w_.apart.push(pair);
    prefetch(pair.place[side], side);
    auto at = w_.overlapping.end();  // deepest overlap on top
    while (at != w_.overlapping.begin() + overlapping_before_ && (at - 1)->least < least) --at;
    w_.overlapping.insert(at, pair);
  }

 private:
  bool pair_caps() {
    return Caps(s_, closest_, w_).pair([&](const Pair& pair) { compare_leaves(pair); });
  }

  Cylinder cylinder_of(const Place& place, int side) const {
    return {s_.pair.cylinders[side]->nodes[place.slot / kWidth], place.slot % kWidth};
  }

  // Fetches the memory that comparing this place will read.
  void prefetch(const Place& place, int side) const {
    if (place.leaf()) {
      prefetch(s_.sites[side]->regions.bounds[place.leaf_number()]);
    } else {
      prefetch(s_.sites[side]->wide.nodes[place.child]);
      if (cylinders_known_) prefetch(s_.pair.cylinders[side]->nodes[place.child]);
    }
  }
  template <class T>
  static void prefetch(const T& object) {
    constexpr size_t kLine = 64;
    const auto* bytes = reinterpret_cast<const std::byte*>(&object);
    for (size_t at = 0; at < sizeof(T); at += kLine) hwy::Prefetch(bytes + at);
  }

  // The faces of a leaf larger than the other node are more likely to cross boxes that are half inside its
  // box than those deep inside, as of a body in a large box: changes the order of overlapping children.
  void prefer_crossing(int side, const tree::WideTree::Node& node, float (&least)[kWidth]) const {
    for (uint32_t i = 0; i < node.count; ++i) {
      if (least[i] > 0) continue;
      float size = 0;
      for (int k = 0; k < 3; ++k) size += node.upper[k][i] - node.lower[k][i];
      const float half = s_.maps.unit[side] * size / 6;
      least[i] = std::min(0.0f, std::abs(least[i] + half) - half);
    }
  }

  // Lower bounds on the distances of the children of one node to the other, from their boxes and then from
  // their cylinders.
  HWY_NOINLINE void bound_children(const Pair& pair, int side, const CentredBox& other,
                                   float (&least)[kWidth]) const {
    const Lanes d;
    const uint32_t index = pair.place[side].child;
    const BoxDistances boxes(s_.maps, closest_.direction(), side, other);
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
      hn::Store(boxes(s_.sites[side]->wide.nodes[index], i), d, least + i);
    if (!cylinders_known_ || pair.place[1 - side].slot == kNone) return;
    const CylinderDistances cylinders(s_.maps, closest_.direction(), side,
                                      cylinder_of(pair.place[1 - side], 1 - side));
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      const Vec before = hn::Load(d, least + i), apart = cylinders(s_.pair.cylinders[side]->nodes[index], i);
      // Where the cylinders overlap, the boxes say how deep.
      hn::Store(hn::IfThenElse(hn::Gt(apart, hn::Zero(d)), hn::Max(before, apart), before), d, least + i);
    }
  }

  // The box of a leaf with large faces is a loose bound: against a smaller box, its faces are bounded one by
  // one. Returns whether this pair is finished; otherwise it is opened later.
  bool put_off(Pair pair, int large, const CentredBox (&box)[2]) {
    // The discs around the faces bound in less time, unless they are much larger.
    constexpr float kMuch = separate ? 4 : 0;
    const bool by_discs =
        cylinders_known_ && pair.place[1 - large].slot != kNone &&
        box[large].size() * s_.maps.unit[large] <= kMuch * box[1 - large].size() * s_.maps.unit[1 - large];
    const float least =
        by_discs ? distance_of_discs(pair, large) : distance_of_faces(pair, large, box[1 - large]);
    if (least > closest_.limit()) return true;
    if (!(least > std::max(pair.least, 0.0f))) return false;
    pair.least = least;
    w_.apart.push(pair);
    return true;
  }
  float distance_of_faces(const Pair& pair, int side, const CentredBox& other) {
    load_faces(side, pair.place[side].leaf_number());
    const PlacedBox box = side == 1 ? PlacedBox(other) : PlacedBox(other, s_.maps.to[0]);
    return s_.maps.unit[0] * (least_distance(faces_[side], box) - s_.maps.to[0].error);
  }
  float distance_of_discs(const Pair& pair, int side) const {
    alignas(64) float apart[kWidth];
    return *std::min_element(apart, apart + bound_discs(pair, side, apart));
  }

  // Lower bounds on the distances of the faces of one leaf, from the discs around them, to the cylinder
  // around the other node. Returns the number of faces.
  uint32_t bound_discs(const Pair& pair, int side, float (&apart)[kWidth]) const {
    const sites::Regions& regions = s_.sites[side]->regions;
    const uint32_t leaf = pair.place[side].leaf_number();
    const CylinderDistances distances(s_.maps, closest_.direction(), side,
                                      cylinder_of(pair.place[1 - side], 1 - side));
    const Lanes d;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
      hn::Store(distances(regions.bounds[leaf], regions.thin[leaf] != 0, i), d, apart + i);
    return regions.leaves[leaf + 1] - regions.leaves[leaf];
  }

  // Whether all faces of the leaves are too far apart in the direction between the closest points found so
  // far.
  bool discs_apart(const Pair& pair) const {
    if (!closest_.direction().known) return false;
    float apart = closest_.direction().offset - s_.maps.to[0].error;
    for (int side = 0; side < 2; ++side)
      apart += least_along(s_.sites[side]->regions, pair.place[side].leaf_number(),
                           closest_.direction().along[side]);
    return s_.maps.unit[0] * apart > closest_.limit();
  }

  // The faces of one leaf that are not too far from the cylinder around the other leaf, a bit for each.
  uint32_t faces_near(const Pair& pair, int side) const {
    alignas(64) float apart[kWidth];
    const uint32_t count = cylinders_known_ ? bound_discs(pair, side, apart) : 0;
    if (count == 0) return ~0u;
    uint32_t near = 0;
    for (uint32_t i = 0; i < count; ++i) near |= (apart[i] > closest_.limit() ? 0u : 1u) << i;
    return near;
  }

  void load_faces(int side, uint32_t leaf) {
    faces_[side].place(*s_.sites[side], leaf, side == 1 ? &s_.maps.to[0] : nullptr);
  }

  HWY_NOINLINE void compare_leaves(const Pair& pair) {
    if (discs_apart(pair)) return;  // the direction may have improved since the leaves were paired
    const uint32_t near1 = faces_near(pair, 0);
    const uint32_t near2 = near1 == 0 ? 0 : faces_near(pair, 1);
    if (near2 == 0) return;
    for (int side = 0; side < 2; ++side) load_faces(side, pair.place[side].leaf_number());
    const LeafFaces &a = faces_[0], &b = faces_[1];
    const Lanes d;
    uint32_t touching[kWidth] = {}, any = 0;  // faces of O2, a bit for each, by faces of O1
    for (uint32_t j = 0; j < b.count(); ++j) {
      if ((near2 >> j & 1) == 0) continue;
      alignas(64) float least[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
        hn::Store(s_.in_units(face_distances(a, i, b, j, closest_.direction())), d, least + i);
      for (uint32_t i = 0; i < a.count(); ++i) {
        if (least[i] > closest_.limit() || (near1 >> i & 1) == 0) continue;
        if (!(least[i] > 0))
          touching[i] |= any = 1u << j;
        else if constexpr (separate)
          closest_.add({least[i], a.first() + i, b.first() + j});
      }
    }
    if (any != 0) find_intersection(touching);
  }

  // Finds the first of these faces that intersect, in the order of the trees; the others may be closest.
  HWY_NOINLINE void find_intersection(const uint32_t (&touching)[kWidth]) {
    for (uint32_t i = 0; i < faces_[0].count(); ++i) {
      if (touching[i] == 0) continue;
      const uint32_t owner1 = faces_[0].first() + i, face1 = s_.sites[0]->tree.items[owner1];
      const Corners a = s_.pair.face1(face1);
      for (uint32_t bits = touching[i]; bits != 0; bits &= bits - 1) {
        const uint32_t owner2 = faces_[1].first() + static_cast<uint32_t>(std::countr_zero(bits));
        const uint32_t face2 = s_.sites[1]->tree.items[owner2];
        const Corners b = s_.pair.face2(face2);
        if (!triangles_intersect(a, b)) {
          if constexpr (separate) closest_.add({0, owner1, owner2});
          continue;
        }
        intersection_ = {0, true, {}, {}, face1, face2};
        if constexpr (separate) intersection_.point1 = intersection_.point2 = common_point(a, b);
        return;
      }
    }
  }

  const Surfaces s_;
  const bool cylinders_known_;  // of both
  PairWorkspace& w_;
  ClosestFaces closest_;
  Separation intersection_;
  std::ptrdiff_t overlapping_before_ = 0;  // the pairs that are on the stack before the children of this one
  LeafFaces faces_[2];
};

}  // namespace

Separation FindClosest(const MeshPair& pair, double bound, PairWorkspace& workspace, const FacePair& hint) {
  PairSearch<true> search(pair, bound, workspace);
  if (hint != kNoFaces)
    search.closest().begin_with(hint);
  else
    search.closest().look_ahead();
  return search.run();
}
FacePair FindCommonFaces(const MeshPair& pair, PairWorkspace& workspace) {
  const Separation found = PairSearch<false>(pair, 0, workspace).run();
  return found.intersecting ? FacePair{found.face1, found.face2} : kNoFaces;
}

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::pairs {

HWY_EXPORT(FindClosest);
HWY_EXPORT(FindCommonFaces);

Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace, const FacePair& hint) {
  return HWY_DYNAMIC_DISPATCH(FindClosest)(pair, bound, workspace, hint);
}

FacePair find_common_faces(const MeshPair& pair, PairWorkspace& workspace, const FacePair& hint) {
  if (hint != kNoFaces && triangles_intersect(pair.face1(hint[0]), pair.face2(hint[1]))) return hint;
  if (have_separating_axis(pair)) return kNoFaces;
  return HWY_DYNAMIC_DISPATCH(FindCommonFaces)(pair, workspace);
}

Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace) {
  const FacePair faces = HWY_DYNAMIC_DISPATCH(FindCommonFaces)(pair, workspace);
  if (faces == kNoFaces) return {};
  const Vec3 point = common_point(pair.face1(faces[0]), pair.face2(faces[1]));
  return {0, true, point, point, faces[0], faces[1]};
}

}  // namespace sdm::pairs
#endif

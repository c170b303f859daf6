#include "query/pairs/pair_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "query/pairs/pair_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "core/cancellation.h"
#include "geometry/lanes/triangle_pair-inl.h"
#include "query/pairs/cylinder_lanes-inl.h"
#include "query/pairs/face_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

using Entry = PairWorkspace::Entry;
using Candidate = PairWorkspace::Candidate;
using Tie = PairWorkspace::Tie;
using Place = PairWorkspace::Place;

constexpr double kNoDistance = std::numeric_limits<double>::infinity();

// The leaves of a surface that are nearest to the other one in some direction.
struct Cap {
  static constexpr size_t kMost = 32;

  std::array<Place, kMost> place;
  std::array<float, kMost> along;
  std::array<tree::WideTree::Node, kMost / kWidth> boxes;
  size_t count = 0;

  void add(const Place& leaf, float extent, const tree::FloatBox& box) {
    tree::WideTree::Node& group = boxes[count / kWidth];
    for (int k = 0; k < 3; ++k)
      group.lo[k][count % kWidth] = box.lo[k], group.hi[k][count % kWidth] = box.hi[k];
    place[count] = leaf, along[count] = extent;
    ++count;
  }
};

// The faces of a cap that are nearest to the other surface, in O1's frame.
struct CapFaces {
  static constexpr size_t kMost = 64;

  std::array<LeafFaces, kMost / kWidth> block;
  alignas(64) std::array<float, kMost> along;  // where each begins, towards the other surface
  std::array<std::uint32_t, kMost> owner;
  size_t count = 0;

  // Fills the last block with its last face.
  void finish() {
    for (size_t lane = count; lane % kWidth != 0; ++lane)
      block[lane / kWidth].set(lane % kWidth, block[lane / kWidth], (count - 1) % kWidth);
    for (size_t b = 0; kWidth * b < count; ++b) block[b].find_normals();
  }
};

// `separate`: searches for the closest faces, otherwise for any that intersect.
template <bool separate>
class PairSearch {
 public:
  PairSearch(const MeshPair& pair, double bound, PairWorkspace& workspace)
      : pair_(pair),
        sites_{&pair.o1, &pair.o2},
        maps_(pair),
        cylinders_known_(pair.has_cylinders()),
        w_(workspace),
        bound_(bound) {
    limit_ = maps_.round_up(bound + maps_.rounding());
  }

  // Any direction bounds distances from below, and that from one body to the other bounds most.
  void look_ahead() {
    Vec3 middle[2];
    for (int side = 0; side < 2; ++side) {
      const tree::FloatBox& box = sites_[side]->tree.box(0);
      for (int k = 0; k < 3; ++k) middle[side][k] = 0.5 * (double{box.lo[k]} + box.hi[k]);
      middle[side] = sites_[side]->frame.origin + (1 / sites_[side]->frame.scale) * middle[side];
    }
    direction_ = maps_.direction(pair_.pose(middle[1]) - middle[0]);
  }

  // Faces that bound the search from the start.
  void begin_with(const FacePair& faces) {
    restrict(std::sqrt(points_of(faces).squared));
    direction_ = maps_.direction(points_.point2 - points_.point1);
  }

  Separation run() {
    w_.overlapping.clear(), w_.apart.clear(), w_.candidates.clear(), w_.ties.clear();
    // Without a bound, caps of large meshes are mostly too large: trying costs a tenth of the search.
    if (!separate || bound_ == kNoDistance || !pair_caps()) w_.overlapping.assign(1, {});
    Entry entry;
    Poll due(256);
    while (!intersection_.intersecting) {
      due();
      const bool more = next(entry);
      if (more && entry.leaves())
        compare_leaves(entry);
      else if (more)
        open(entry);
      else if (w_.candidates.empty())
        break;
      // Many at a time, unless the limit is still loose.
      if (!more || least_ == kNoDistance || w_.candidates.size() >= TrianglePairs::kLanes)
        compare_candidates();
    }
    return intersection_.intersecting ? intersection_ : closest();
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

  // If a plane across the direction separates the surfaces, pairs the leaves of each that are near enough to
  // the other one's side of it, without opening a pair of nodes. Returns whether it did.
  bool pair_caps() {
    if (!direction_.known) return false;
    Place first[2];
    float along[2];
    for (int side = 0; side < 2; ++side) along[side] = find_first(side, first[side]);
    if (!(extent(along[0], along[1]) > 0)) return false;
    if (least_ == kNoDistance && !(extent(along[0], along[1]) > limit_)) {
      // The two leaves that are nearest to the plane give a bound and a better direction.
      compare_leaves({.place = {first[0], first[1]}});
      compare_candidates();
      for (int side = 0; side < 2; ++side) along[side] = find_first(side, first[side]);
      if (!(extent(along[0], along[1]) > 0)) return false;
    }
    if (extent(along[0], along[1]) > limit_) return true;
    for (int side = 0; side < 2; ++side)
      if (!collect_cap(side, along[1 - side])) return false;
    if (collect_faces(0, along[1]) && collect_faces(1, along[0]))
      pair_faces_of_caps();
    else
      pair_leaves_of_caps();
    return true;
  }

  // A lower bound on the distance of things that have these extents along the direction.
  float extent(float along1, float along2) const {
    return maps_.unit[0] * (along1 + along2 + direction_.offset - maps_.to[0].error);
  }

  // Lower bounds on x·u over the boxes of the children.
  HWY_INLINE Vec along_children(int side, const tree::WideTree::Node& node, size_t i) const {
    const Lanes d;
    Vec least = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const float u = direction_.along[side][k];
      least = hn::MulAdd(hn::Set(d, u), hn::Load(d, (u > 0 ? node.lo : node.hi)[k] + i), least);
    }
    return least;
  }

  // The smallest lower bound on x·u over the leaves, and the leaf that has it.
  float find_first(int side, Place& first) {
    float least = std::numeric_limits<float>::infinity();
    visit_leaves(
        side, [&] { return least; },
        [&](const Place& place, float) HWY_ATTR {
          const float along = least_along(sites_[side]->regions, place.leaf_number(), direction_.along[side]);
          if (along < least) least = along, first = place;
          return true;
        });
    return least;
  }

  // The leaves that are not too far, given that the other surface extends to `along`. Returns false if there
  // are too many.
  bool collect_cap(int side, float along) {
    Cap& cap = caps_[side];
    cap.count = 0;
    const auto far = [&](float mine) { return extent(mine, along) > limit_; };
    const float most = limit_ / maps_.unit[0] - along - direction_.offset + 2 * maps_.to[0].error;
    return visit_leaves(
        side, [&] { return most; },
        [&](const Place& place, float) HWY_ATTR {
          const float mine = least_along(sites_[side]->regions, place.leaf_number(), direction_.along[side]);
          if (far(mine)) return true;
          if (cap.count == Cap::kMost) return false;
          cap.add(place, mine, box_of(place, side));
          return true;
        });
  }

  // Calls visit(place, along) for the leaves whose boxes are not beyond most(), the first ones first, until
  // it returns false.
  template <class Most, class Visit>
  HWY_INLINE bool visit_leaves(int side, const Most& most, const Visit& visit) {
    const Lanes d;
    std::vector<PairWorkspace::Ahead>& stack = w_.ahead;
    stack.assign(1, {{}, -std::numeric_limits<float>::infinity()});
    while (!stack.empty()) {
      const PairWorkspace::Ahead next = stack.back();
      stack.pop_back();
      if (!(next.along <= most())) continue;
      if (next.place.leaf()) {
        if (!visit(next.place, next.along)) return false;
        continue;
      }
      const tree::WideTree::Node& node = sites_[side]->wide.nodes[next.place.child];
      alignas(64) float along[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
        hn::Store(along_children(side, node, i), d, along + i);
      const auto base = static_cast<std::ptrdiff_t>(stack.size());
      for (uint32_t i = 0; i < node.count; ++i) {
        if (!(along[i] <= most())) continue;
        auto at = stack.end();
        while (at != stack.begin() + base && (at - 1)->along < along[i]) --at;
        stack.insert(at, {Place::of(node, next.place.child, i), along[i]});
      }
    }
    return true;
  }

  // The faces of a cap that are not too far, given that the other surface begins at `along`. Returns false if
  // there are too many.
  bool collect_faces(int side, float along) {
    const Lanes d;
    const Cap& cap = caps_[side];
    CapFaces& faces = cap_faces_[side];
    faces.count = 0;
    // O2's faces are moved to O1's frame, in which the direction of either surface is that of O1 or opposite.
    const float sign = side == 0 ? 1.0f : -1.0f, offset = direction_.offset;
    Vec axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = hn::Set(d, sign * direction_.along[0][k]);
    const float rest = side == 0 ? along + offset : along;
    const float most = limit_ / maps_.unit[0] - rest + 2 * maps_.to[0].error;
    LeafFaces& leaf = faces_[side];
    for (size_t n = 0; n < cap.count; ++n) {
      leaf.load(*sites_[side], cap.place[n].leaf_number());
      if (side == 1) leaf.move(maps_.to[0]);
      alignas(64) float least[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
        Vec corner[3][3];
        leaf.corners(i, corner);
        hn::Store(Extent::of(corner, axis).lo, d, least + i);
      }
      for (uint32_t i = 0; i < leaf.count(); ++i) {
        if (!(least[i] <= most)) continue;
        if (faces.count == CapFaces::kMost) return false;
        faces.block[faces.count / kWidth].set(faces.count % kWidth, leaf, i);
        faces.along[faces.count] = least[i];
        faces.owner[faces.count++] = leaf.first() + i;
      }
    }
    if (faces.count > 0) faces.finish();
    return true;
  }

  // As no faces intersect, any of them may be closest.
  void pair_faces_of_caps() {
    const Lanes d;
    const CapFaces &a = cap_faces_[0], &b = cap_faces_[1];
    for (size_t j = 0; j < b.count; ++j) {
      const float most = limit_ / maps_.unit[0] - b.along[j] + 2 * maps_.to[0].error;
      for (size_t n = 0; kWidth * n < a.count; ++n) {
        alignas(64) float least[kWidth];
        for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
          const Vec along = hn::Load(d, a.along.data() + kWidth * n + i);
          if (hn::AllTrue(d, hn::Gt(along, hn::Set(d, most))))
            hn::Store(hn::Inf(d), d, least + i);
          else
            hn::Store(in_units(face_distances(a.block[n], i, b.block[j / kWidth],
                                              static_cast<uint32_t>(j % kWidth), direction_)),
                      d, least + i);
        }
        for (size_t i = 0; i < kWidth && kWidth * n + i < a.count; ++i)
          if (least[i] <= limit_)
            w_.candidates.push_back({std::max(least[i], 0.0f), a.owner[kWidth * n + i], b.owner[j]});
      }
    }
  }

  void pair_leaves_of_caps() {
    const Lanes d;
    const Cap &cap1 = caps_[0], &cap2 = caps_[1];
    for (size_t j = 0; j < cap2.count; ++j) {
      const CentredBox box(box_of(cap2.place[j], 1));
      const BoxDistances distances(maps_, direction_, 0, box);
      for (size_t group = 0; kWidth * group < cap1.count; ++group) {
        alignas(64) float least[kWidth];
        for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
          hn::Store(distances(cap1.boxes[group], i), d, least + i);
        for (size_t i = 0; i < kWidth && kWidth * group + i < cap1.count; ++i) {
          const size_t at = kWidth * group + i;
          const float bound = std::max(least[i], extent(cap1.along[at], cap2.along[j]));
          if (bound <= limit_) w_.apart.push({{cap1.place[at], cap2.place[j]}, bound});
        }
      }
    }
  }

  // From the wide tree, whose node was just compared.
  tree::FloatBox box_of(const Place& place, int side) const {
    if (place.slot == kNone) return sites_[side]->tree.box(0);
    const tree::WideTree::Node& node = sites_[side]->wide.nodes[place.slot / kWidth];
    tree::FloatBox box;
    for (int k = 0; k < 3; ++k)
      box.lo[k] = node.lo[k][place.slot % kWidth], box.hi[k] = node.hi[k][place.slot % kWidth];
    return box;
  }

  Cylinder cylinder_of(const Place& place, int side) const {
    return {pair_.cylinders[side]->nodes[place.slot / kWidth], place.slot % kWidth};
  }

  // What comparing this place will read.
  void prefetch(const Place& place, int side) const {
    if (place.leaf()) {
      prefetch(sites_[side]->regions.bounds[place.leaf_number()]);
    } else {
      prefetch(sites_[side]->wide.nodes[place.child]);
      if (cylinders_known_) prefetch(pair_.cylinders[side]->nodes[place.child]);
    }
  }
  template <class T>
  static void prefetch(const T& object) {
    constexpr size_t kLine = 64;
    const auto* bytes = reinterpret_cast<const std::byte*>(&object);
    for (size_t at = 0; at < sizeof(T); at += kLine) hwy::Prefetch(bytes + at);
  }

  // Pairs the children of the larger node with the other node.
  void open(const Entry& entry) {
    const CentredBox box[2] = {CentredBox(box_of(entry.place[0], 0)), CentredBox(box_of(entry.place[1], 1))};
    const int larger = box[0].size() * maps_.unit[0] < box[1].size() * maps_.unit[1];
    const int side = entry.place[larger].leaf() ? 1 - larger : larger;
    if (side != larger && put_off(entry, larger, box)) return;
    const uint32_t index = entry.place[side].child;
    const tree::WideTree::Node& node = sites_[side]->wide.nodes[index];
    alignas(64) float least[kWidth];
    bound_children(entry, side, box[1 - side], least);

    const auto base = static_cast<std::ptrdiff_t>(w_.overlapping.size());
    if (side != larger) prefer_crossing(side, node, least);
    for (uint32_t i = 0; i < node.count; ++i) {
      if (least[i] > limit_) continue;
      Entry child = entry;
      child.place[side] = Place::of(node, index, i);
      child.least = least[i];
      if (child.leaves() && discs_apart(child)) continue;
      if (least[i] > 0) {
        w_.apart.push(child);
        continue;
      }
      prefetch(child.place[side], side);
      auto at = w_.overlapping.end();  // deepest overlap on top
      while (at != w_.overlapping.begin() + base && (at - 1)->least < child.least) --at;
      w_.overlapping.insert(at, child);
    }
  }

  // The faces of a leaf larger than the other node are more likely to cross boxes that are half inside its
  // box than those deep inside, as of a body in a large box: changes the order of overlapping children.
  void prefer_crossing(int side, const tree::WideTree::Node& node, float (&least)[kWidth]) const {
    for (uint32_t i = 0; i < node.count; ++i) {
      if (least[i] > 0) continue;
      float size = 0;
      for (int k = 0; k < 3; ++k) size += node.hi[k][i] - node.lo[k][i];
      const float half = maps_.unit[side] * size / 6;
      least[i] = std::min(0.0f, std::abs(least[i] + half) - half);
    }
  }

  // Lower bounds on the distances of the children of one node to the other, from their boxes and then from
  // their cylinders.
  void bound_children(const Entry& entry, int side, const CentredBox& other, float (&least)[kWidth]) const {
    const Lanes d;
    const uint32_t index = entry.place[side].child;
    const BoxDistances boxes(maps_, direction_, side, other);
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
      hn::Store(boxes(sites_[side]->wide.nodes[index], i), d, least + i);
    if (!cylinders_known_ || entry.place[1 - side].slot == kNone) return;
    const CylinderDistances cylinders(maps_, direction_, side, cylinder_of(entry.place[1 - side], 1 - side));
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      const Vec before = hn::Load(d, least + i), apart = cylinders(pair_.cylinders[side]->nodes[index], i);
      // Where the cylinders overlap, the boxes say how deep.
      hn::Store(hn::IfThenElse(hn::Gt(apart, hn::Zero(d)), hn::Max(before, apart), before), d, least + i);
    }
  }

  // The box of a leaf with large faces is a loose bound: against a smaller box, its faces are bounded one by
  // one. Returns whether this pair is finished; otherwise it is opened later.
  bool put_off(Entry entry, int large, const CentredBox (&box)[2]) {
    // By the discs around the faces, which take less time, unless they are much larger.
    constexpr float kMuch = separate ? 4 : 0;
    const bool by_discs =
        cylinders_known_ && entry.place[1 - large].slot != kNone &&
        box[large].size() * maps_.unit[large] <= kMuch * box[1 - large].size() * maps_.unit[1 - large];
    const float least =
        by_discs ? distance_of_discs(entry, large) : distance_of_faces(entry, large, box[1 - large]);
    if (least > limit_) return true;
    if (!(least > std::max(entry.least, 0.0f))) return false;
    entry.least = least;
    w_.apart.push(entry);
    return true;
  }
  float distance_of_faces(const Entry& entry, int side, const CentredBox& other) {
    load_faces(side, entry.place[side].leaf_number());
    const PlacedBox box = side == 1 ? PlacedBox(other) : PlacedBox(other, maps_.to[0]);
    return maps_.unit[0] * (least_distance(faces_[side], box) - maps_.to[0].error);
  }
  float distance_of_discs(const Entry& entry, int side) const {
    alignas(64) float apart[kWidth];
    return *std::min_element(apart, apart + bound_discs(entry, side, apart));
  }

  // Lower bounds on the distances of the faces of one leaf, from the discs around them, to the cylinder
  // around the other node. Returns the number of faces.
  uint32_t bound_discs(const Entry& entry, int side, float (&apart)[kWidth]) const {
    const sites::Regions& regions = sites_[side]->regions;
    const uint32_t leaf = entry.place[side].leaf_number();
    const CylinderDistances distances(maps_, direction_, side, cylinder_of(entry.place[1 - side], 1 - side));
    const Lanes d;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
      hn::Store(distances(regions.bounds[leaf], regions.thin[leaf] != 0, i), d, apart + i);
    return regions.leaves[leaf + 1] - regions.leaves[leaf];
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

  // The faces of one leaf that are not too far from the cylinder around the other leaf, a bit for each.
  uint32_t faces_near(const Entry& entry, int side) const {
    alignas(64) float apart[kWidth];
    const uint32_t count = cylinders_known_ ? bound_discs(entry, side, apart) : 0;
    if (count == 0) return ~0u;
    uint32_t near = 0;
    for (uint32_t i = 0; i < count; ++i) near |= (apart[i] > limit_ ? 0u : 1u) << i;
    return near;
  }

  void load_faces(int side, uint32_t leaf) {
    faces_[side].place(*sites_[side], leaf, side == 1 ? &maps_.to[0] : nullptr);
  }

  void compare_leaves(const Entry& entry) {
    if (discs_apart(entry)) return;  // the direction may have improved since the leaves were paired
    const uint32_t near1 = faces_near(entry, 0);
    const uint32_t near2 = near1 == 0 ? 0 : faces_near(entry, 1);
    if (near2 == 0) return;
    for (int side = 0; side < 2; ++side) load_faces(side, entry.place[side].leaf_number());
    const LeafFaces &a = faces_[0], &b = faces_[1];
    const Lanes d;
    Candidate touching[kWidth * kWidth];
    size_t count = 0;
    for (uint32_t j = 0; j < b.count(); ++j) {
      if ((near2 >> j & 1) == 0) continue;
      alignas(64) float least[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
        hn::Store(in_units(face_distances(a, i, b, j, direction_)), d, least + i);
      for (uint32_t i = 0; i < a.count(); ++i) {
        if (least[i] > limit_ || (near1 >> i & 1) == 0) continue;
        const Candidate candidate{least[i], a.first() + i, b.first() + j};
        if (least[i] > 0)
          w_.candidates.push_back(candidate);
        else
          touching[count++] = candidate;
      }
    }
    find_intersection({touching, count});
  }

  HWY_INLINE Vec in_units(Vec distance) const {
    const Lanes d;
    return hn::Mul(hn::Set(d, maps_.unit[0]), hn::Sub(distance, hn::Set(d, maps_.to[0].error)));
  }

  // Of candidates that may intersect, the first that do, in the order of the trees; the others may be
  // closest.
  void find_intersection(std::span<Candidate> touching) {
    std::ranges::sort(touching, {}, [](const Candidate& c) { return std::pair(c.owner1, c.owner2); });
    for (const Candidate& candidate : touching) {
      const FacePair faces = faces_of(candidate);
      const Corners a = pair_.face1(faces[0]), b = pair_.face2(faces[1]);
      if (squared_box_distance(a, b) > 0 || !triangles_intersect(a, b)) {
        if constexpr (separate) w_.candidates.push_back({0, candidate.owner1, candidate.owner2});
        continue;
      }
      const Vec3 point = common_point(a, b);
      intersection_ = {0, true, point, point, faces[0], faces[1]};
      return;
    }
  }

  FacePair faces_of(const Candidate& candidate) const {
    return {sites_[0]->tree.items[candidate.owner1], sites_[1]->tree.items[candidate.owner2]};
  }

  // Nearest first, which excludes most of the others if there are many.
  void compare_candidates() {
    std::vector<Candidate>& all = w_.candidates;
    if constexpr (separate) {
      if (all.size() > TrianglePairs::kLanes) std::ranges::sort(all, {}, &Candidate::least);
      Poll due(256);
      for (size_t next = 0; next < all.size() && !(all[next].least > limit_); due())
        next = compare_some(next);
    }
    all.clear();
  }

  // Compares as many candidates as there are lanes, from `next` on. Returns the first one after them.
  size_t compare_some(size_t next) {
    const double most = limit();
    // Most pairs are excluded by their boxes in double precision if the meshes have details too fine for
    // single precision, else none.
    constexpr float kFine = 1e-3f;
    const bool fine = maps_.unit[0] * maps_.to[0].error > kFine * limit_;
    FacePair faces[TrianglePairs::kLanes];
    size_t count = 0;
    for (; next < w_.candidates.size() && count < TrianglePairs::kLanes; ++next) {
      const FacePair pair = faces_of(w_.candidates[next]);
      const Corners a = pair_.face1(pair[0]), b = pair_.face2(pair[1]);
      if (fine && squared_box_distance(a, b) > most * most) continue;
      pairs_.set(count, a, b);
      faces[count++] = pair;
    }
    double squared[TrianglePairs::kLanes];
    pairs_.squared_distances(count, squared);
    if (count == 0) return next;
    const size_t least = static_cast<size_t>(std::min_element(squared, squared + count) - squared);
    if (const double distance = std::sqrt(squared[least]); distance < least_) {
      const bool closer = distance < least_ - maps_.rounding();
      restrict(distance);
      if (closer) {
        std::erase_if(w_.ties, [&](const Tie& tie) { return tie.distance > limit(); });
        points_of(faces[least]);
        direction_ = maps_.direction(points_.point2 - points_.point1);
      }
    }
    for (size_t i = 0; i < count; ++i)
      if (const double distance = std::sqrt(squared[i]); distance <= limit())
        w_.ties.push_back({distance, faces[i]});
    return next;
  }

  // The closest points of two faces; those of the last ones are kept.
  const PointPair& points_of(const FacePair& faces) {
    if (faces != faces_of_points_) points_ = closest_points(pair_.face1(faces[0]), pair_.face2(faces[1]));
    faces_of_points_ = faces;
    return points_;
  }

  // Faces at larger distances than this are not closest.
  double limit() const { return std::min(least_, bound_) + maps_.rounding(); }
  void restrict(double distance) {
    least_ = std::min(least_, distance);
    limit_ = maps_.round_up(limit());
  }

  // The result depends on which pairs are tied, not on the order in which they were found.
  Separation closest() {
    FacePair first = kNoFaces;
    double least = kNoDistance;
    for (const Tie& tie : w_.ties) least = std::min(least, tie.distance);
    for (const Tie& tie : w_.ties)
      if (tie.distance <= least + maps_.rounding()) first = std::min(first, tie.faces);
    if (first == kNoFaces) return {};
    const PointPair& points = points_of(first);
    const double distance = std::sqrt(points.squared);
    if (distance > bound_) return {};
    return {distance, false, points.point1, points.point2, first[0], first[1]};
  }

  const MeshPair& pair_;
  const sites::SitesData* sites_[2];
  const UnitMaps maps_;
  const bool cylinders_known_;  // of both
  PairWorkspace& w_;
  const double bound_;
  double least_ = kNoDistance;  // the smallest distance of two faces that is known
  FacePair faces_of_points_ = kNoFaces;
  PointPair points_{};
  Separation intersection_;
  float limit_;          // pairs farther than this are excluded
  Direction direction_;  // from the closest point of O1 found so far to that of O2
  Cap caps_[2];
  CapFaces cap_faces_[2];
  LeafFaces faces_[2];
  TrianglePairs pairs_;
};

Separation FindClosest(const MeshPair& pair, double bound, PairWorkspace& workspace, const FacePair& hint) {
  PairSearch<true> search(pair, bound, workspace);
  if (hint != kNoFaces)
    search.begin_with(hint);
  else
    search.look_ahead();
  return search.run();
}
Separation FindIntersection(const MeshPair& pair, PairWorkspace& workspace) {
  return PairSearch<false>(pair, 0, workspace).run();
}

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::pairs {

HWY_EXPORT(FindClosest);
HWY_EXPORT(FindIntersection);

namespace {

// Tests for an axis that separates the surfaces, by the boxes around them: far cheaper than a search.
class SeparatingAxis {
 public:
  explicit SeparatingAxis(const MeshPair& pair) : pair_(pair) {
    constexpr double kRounding = 1e-12;  // more than that of a posed point
    const tree::FloatBox &box1 = pair.o1.tree.box(0), &box2 = pair.o2.tree.box(0);
    const UnitFrame &frame1 = pair.o1.frame, &frame2 = pair.o2.frame;
    const double unit1 = 1 / frame1.scale, unit2 = 1 / frame2.scale;
    const auto middle = [](const tree::FloatBox& box, int k) {
      return 0.5 * (double{box.lo[k]} + box.hi[k]);
    };
    const auto half = [](const tree::FloatBox& box, int k) { return 0.5 * (double{box.hi[k]} - box.lo[k]); };
    for (int k = 0; k < 3; ++k) {
      const Vec3& row = pair.pose.rows[k];
      double at = pair.pose.offset[k], size = std::abs(at) + std::abs(frame1.origin[k]) + unit1;
      half1_[k] = unit1 * half(box1, k);
      for (int j = 0; j < 3; ++j) {
        at += row[j] * (frame2.origin[j] + unit2 * middle(box2, j));
        size += std::abs(row[j]) * (std::abs(frame2.origin[j]) + unit2);
        edge_[j][k] = row[j] * unit2 * half(box2, j);
      }
      between_[k] = at - frame1.origin[k] - unit1 * middle(box1, k);
      rounding_[k] = kRounding * size;
    }
  }

  // By the axes of the separating axis theorem, the normals of faces and the products of two edges, of the
  // whole boxes. The one that overlaps least may separate those of the children.
  bool exists() {
    for (int k = 0; k < 3; ++k) {
      Vec3 axis{};
      axis[k] = 1;
      if (separates(axis)) return true;
    }
    for (int j = 0; j < 3; ++j)
      if (separates(cross(edge_[j], edge_[(j + 1) % 3]))) return true;
    if (separates_children(between_)) return true;
    for (const auto& [x, y, z] : edge_)
      if (separates({0, -z, y}) || separates({z, 0, -x}) || separates({-y, x, 0})) return true;
    return separates_children(best_);
  }

 private:
  // Whether this axis does, by the boxes around the surfaces.
  bool separates(const Vec3& axis) {
    double reach = 0;
    for (int k = 0; k < 3; ++k) reach += std::abs(axis[k]) * (half1_[k] + rounding_[k]);
    for (int j = 0; j < 3; ++j) reach += std::abs(dot(axis, edge_[j]));
    const double overlap = reach - std::abs(dot(axis, between_));
    if (overlap < 0) return true;
    // Compared without roots: overlap / |axis|.
    const double squared = overlap * overlap, size = squared_norm(axis);
    if (squared * least_size_ < least_ * size) least_ = squared, least_size_ = size, best_ = axis;
    return false;
  }

  // By those around the children of the roots.
  bool separates_children(const Vec3& axis) const {
    const Vec3 u = dot(axis, between_) < 0 ? -axis : axis;
    Vec3 u2;
    for (int j = 0; j < 3; ++j)
      u2[j] = -(pair_.pose.rows[0][j] * u[0] + pair_.pose.rows[1][j] * u[1] + pair_.pose.rows[2][j] * u[2]);
    double error = 0;
    for (int k = 0; k < 3; ++k) error += 2 * std::abs(u[k]) * rounding_[k];
    return extent(pair_.o1, u) + extent(pair_.o2, u2) < dot(u, pair_.pose.offset) - error;
  }
  // The largest x·u over the surface, at most.
  static double extent(const sites::SitesData& sites, const Vec3& u) {
    const tree::WideTree::Node& root = sites.wide.nodes[0];
    double most = -std::numeric_limits<double>::infinity();
    for (uint32_t i = 0; i < root.count; ++i) {
      double along = 0;
      for (int k = 0; k < 3; ++k) along += u[k] * double{(u[k] > 0 ? root.hi : root.lo)[k][i]};
      most = std::max(most, along);
    }
    return dot(u, sites.frame.origin) + most / sites.frame.scale;
  }

  const MeshPair& pair_;
  Vec3 between_{}, half1_{};    // from one middle to the other; of O1's box
  std::array<Vec3, 3> edge_{};  // of O2's box, half as long
  Vec3 rounding_{};             // bounds on the errors of coordinates
  Vec3 best_{};                 // the axis along which they overlap least
  double least_ = 1;            // the square of that overlap, times that of the axis' length
  double least_size_ = 0;       // the latter; at first, the overlap is infinite
};

}  // namespace

Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace, const FacePair& hint) {
  return HWY_DYNAMIC_DISPATCH(FindClosest)(pair, bound, workspace, hint);
}

Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace) {
  if (SeparatingAxis(pair).exists()) return {};
  return HWY_DYNAMIC_DISPATCH(FindIntersection)(pair, workspace);
}

}  // namespace sdm::pairs
#endif

#include "bodies/pairs/near_faces.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bodies/pairs/near_faces.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include "bodies/pairs/face_lanes-inl.h"
#include "core/parallel.h"
#include "geometry/triangle_pair.h"
#include "tree/visit_pairs.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

using tree::Place;

namespace {

// The policy of a search of both trees.
class NearFacesSearch {
 public:
  using Pair = PairWorkspace::Entry;
  using Half = NearFacesWorkspace::Half;

  NearFacesSearch(const MeshPair& pair, double max_distance, Half& half, NearFaces& near)
      : pair_(pair),
        sites_{&pair.o1, &pair.o2},
        maps_(pair),
        half_(half),
        near_(near),
        exact_(max_distance == 0) {
    limit_ = maps_.round_up(max_distance + maps_.rounding());
    max_distance_ = static_cast<float>(max_distance * pair.o1.frame.scale);
    for (int side = 0; side < 2; ++side) {
      std::vector<uint8_t>& marks = near_.of_leaf[side];
      for (const uint32_t leaf : near_.leaves[side]) marks[leaf] = 0;
      near_.leaves[side].clear();
      marks.resize(sites_[side]->regions.leaves.size() - 1, 0);
      near_.opposite[side].resize(marks.size());
      half_.whole[side].assign(sites_[side]->wide.nodes.size(), 0);
    }
  }

  // Replaces the first of the open pairs by those below it.
  void open_first() {
    tree::visit_pair(sites_[0]->wide, sites_[1]->wide, Pair(half_.open.front()), *this);
    half_.open.erase(half_.open.begin());
  }
  void open_all() { tree::visit_pairs(sites_[0]->wide, sites_[1]->wide, *this); }

  bool next(Pair& pair) {
    if (half_.open.empty()) return false;
    pair = half_.open.back();
    half_.open.pop_back();
    return true;
  }
  bool enter(const Pair& pair) const { return !(is_whole(0, pair.place[0]) && is_whole(1, pair.place[1])); }
  void leaf(const Pair& pair) { compare_leaves(pair.place[0].leaf_number(), pair.place[1].leaf_number()); }

  // Divides the larger node, unless it is a leaf.
  tree::Division bound(const Pair& pair, float (&least)[kWidth]) {
    const CentredBox box[2] = {CentredBox(sites_[0]->tree.box(pair.place[0].source)),
                               CentredBox(sites_[1]->tree.box(pair.place[1].source))};
    if (all_near(box[0], box[1])) {
      const uint32_t faces[2] = {first_face(0, pair.place[0]), first_face(1, pair.place[1])};
      for (int side = 0; side < 2; ++side) mark_all(side, pair.place[side].child, faces[1 - side]);
      return {};
    }
    const int larger = box[0].size() * maps_.unit[0] < box[1].size() * maps_.unit[1];
    const int side = pair.place[larger].leaf() ? 1 - larger : larger;
    if (side != larger && faces_beyond(larger, pair.place[larger].leaf_number(), box[side])) return {};
    const tree::WideTree::Node& node = sites_[side]->wide.nodes[pair.place[side].child];
    const BoxDistances distances(maps_, none_, side, box[1 - side]);
    const Lanes d;
    for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) hn::Store(distances(node, i), d, least + i);
    return {side, children_within(node, least, limit_)};
  }
  void open(const Pair& pair, int /*side*/, float /*least*/) { half_.open.push_back(pair); }

 private:
  // Whether no two points of the boxes are farther apart than the largest distance, in the frame of O1.
  bool all_near(const CentredBox& box1, const CentredBox& box2) const {
    const FrameMap& map = maps_.to[0];
    float squared = 0, half1 = 0, half2 = 0;
    for (int k = 0; k < 3; ++k) {
      float between = map.offset[k] - box1.centre[k];
      for (int j = 0; j < 3; ++j) between += map.row[k][j] * box2.centre[j];
      squared += between * between;
      half1 += box1.half[k] * box1.half[k];
      half2 += box2.half[k] * box2.half[k];
    }
    return std::sqrt(squared) + std::sqrt(half1) + map.stretch * std::sqrt(half2) + map.error < max_distance_;
  }

  // Whether all faces are known to be near.
  bool is_whole(int side, const Place& place) const {
    if (!place.leaf()) return half_.whole[side][place.child] != 0;
    const uint32_t leaf = place.leaf_number();
    return near_.of_leaf[side][leaf] == (1u << count_of(side, leaf)) - 1;
  }
  uint32_t first_face(int side, Place place) const {
    while (!place.leaf()) place.child = sites_[side]->wide.nodes[place.child].child[0];
    return sites_[side]->regions.leaves[place.leaf_number()];
  }
  void mark_all(int side, uint32_t child, uint32_t opposite) {
    if (tree::WideTree::is_leaf(child)) {
      const uint32_t leaf = tree::WideTree::leaf_number(child);
      return mark(side, leaf, (1u << count_of(side, leaf)) - 1, opposite);
    }
    if (half_.whole[side][child] != 0) return;
    half_.whole[side][child] = 1;
    const tree::WideTree::Node& node = sites_[side]->wide.nodes[child];
    for (uint32_t i = 0; i < node.count; ++i) mark_all(side, node.child[i], opposite);
  }

  // Whether all faces of a leaf are too far from a box that is smaller than that of the leaf.
  bool faces_beyond(int side, uint32_t leaf, const CentredBox& small) {
    load_faces(side, leaf);
    const PlacedBox box = side == 1 ? PlacedBox(small) : PlacedBox(small, maps_.to[0]);
    return maps_.unit[0] * (least_distance(faces_[side], box) - maps_.to[0].error) > limit_;
  }

  void load_faces(int side, uint32_t leaf) {
    faces_[side].place(*sites_[side], leaf, side == 1 ? &maps_.to[0] : nullptr);
  }

  void compare_leaves(uint32_t leaf1, uint32_t leaf2) {
    const uint32_t count1 = count_of(0, leaf1), count2 = count_of(1, leaf2);
    uint32_t known1 = near_.of_leaf[0][leaf1], known2 = near_.of_leaf[1][leaf2];
    const uint32_t all1 = (1u << count1) - 1, all2 = (1u << count2) - 1;
    if (known1 == all1 && known2 == all2) return;
    load_faces(0, leaf1);
    load_faces(1, leaf2);
    // The first pair that is near: of a leaf without known faces, it is the same whatever is known of others.
    uint32_t first1 = kNone, first2 = kNone;
    const Lanes d;
    for (uint32_t j = 0; j < count2; ++j) {
      // The faces of leaf1 whose pairs with this one may change something.
      const uint32_t open = (known2 >> j & 1) != 0 ? all1 & ~known1 : all1;
      if (open == 0) continue;
      alignas(64) float least[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
        hn::Store(face_distances(faces_[0], i, faces_[1], j, none_), d, least + i);
      for (uint32_t i = 0; i < count1; ++i) {
        if ((open >> i & 1) == 0 || maps_.unit[0] * (least[i] - maps_.to[0].error) > limit_) continue;
        if ((known1 >> i & 1) != 0 && (known2 >> j & 1) != 0) continue;
        if (exact_ && !intersect(faces_[0].first() + i, faces_[1].first() + j)) continue;
        if (first1 == kNone) {
          first1 = faces_[0].first() + i;
          first2 = faces_[1].first() + j;
        }
        known1 |= 1u << i;
        known2 |= 1u << j;
      }
    }
    if (first1 == kNone) return;
    mark(0, leaf1, known1, first2);
    mark(1, leaf2, known2, first1);
  }

  uint32_t count_of(int side, uint32_t leaf) const {
    const Array<uint32_t>& leaves = sites_[side]->regions.leaves;
    return leaves[leaf + 1] - leaves[leaf];
  }

  bool intersect(uint32_t owner1, uint32_t owner2) const {
    const Corners a = pair_.face1(sites_[0]->tree.items[owner1]),
                  b = pair_.face2(sites_[1]->tree.items[owner2]);
    return squared_box_distance(a, b) == 0 && triangles_intersect(a, b);
  }

  void mark(int side, uint32_t leaf, uint32_t faces, uint32_t opposite) {
    uint8_t& marks = near_.of_leaf[side][leaf];
    if (marks == 0) {
      near_.leaves[side].push_back(leaf);
      near_.opposite[side][leaf] = sites_[1 - side]->tree.items[opposite];
    }
    marks = static_cast<uint8_t>(faces);
  }

  const MeshPair& pair_;
  const sites::SitesData* sites_[2];
  const UnitMaps maps_;
  Half& half_;
  NearFaces& near_;
  const bool exact_;
  float limit_;         // pairs farther than this are not near
  float max_distance_;  // in the unit frame of O1
  const Direction none_;
  LeafFaces faces_[2];
};

}  // namespace

// Adds the faces that the second half has found.
void Merge(const NearFaces& second, NearFaces& near) {
  for (int side = 0; side < 2; ++side)
    for (const uint32_t leaf : second.leaves[side]) {
      if (near.of_leaf[side][leaf] == 0) {
        near.leaves[side].push_back(leaf);
        near.opposite[side][leaf] = second.opposite[side][leaf];
      }
      near.of_leaf[side][leaf] |= second.of_leaf[side][leaf];
    }
}

void FindNearFaces(const MeshPair& pair, double max_distance, NearFacesWorkspace& workspace,
                   NearFaces& near) {
  constexpr size_t kEnough = 64;  // pairs that make halves about equal
  std::vector<PairWorkspace::Entry>& all = workspace.halves[0].open;
  NearFacesSearch first(pair, max_distance, workspace.halves[0], near);
  all.assign(1, {});
  // One core goes through the pairs in the same order as two, so that opposite faces are the same.
  while (!all.empty() && all.size() < kEnough) first.open_first();
  if (all.empty()) return;
  // Neighbours in turn, as most near faces are below a few of the pairs.
  std::vector<PairWorkspace::Entry>& others = workspace.halves[1].open;
  others.clear();
  size_t kept = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (i % 2 == 0)
      all[kept++] = all[i];
    else
      others.push_back(all[i]);
  }
  all.resize(kept);
  if (thread_count() == 1) {
    // The first half is searched before the second, which the faces found so far make shorter.
    first.open_all();
    all.swap(others);
    first.open_all();
    return;
  }
  NearFacesSearch second(pair, max_distance, workspace.halves[1], workspace.second);
  parallel_invoke([&] { first.open_all(); }, [&] { second.open_all(); });
  Merge(workspace.second, near);
}

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::pairs {

HWY_EXPORT(FindNearFaces);

void find_near_faces(const MeshPair& pair, double max_distance, NearFacesWorkspace& workspace,
                     NearFaces& near) {
  HWY_DYNAMIC_DISPATCH(FindNearFaces)(pair, max_distance, workspace, near);
}

}  // namespace sdm::pairs
#endif

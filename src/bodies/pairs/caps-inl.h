// Closest faces of surfaces that a plane separates: only the leaves of each that are near enough to the plane
// are paired. Included once for each set of vector instructions.
#if defined(SDM_PROXIMITY_CAPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_PROXIMITY_CAPS_INL_H
#undef SDM_PROXIMITY_CAPS_INL_H
#else
#define SDM_PROXIMITY_CAPS_INL_H
#endif

#include <algorithm>
#include <array>
#include <limits>

#include "bodies/pairs/closest_faces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {

// The leaves of a surface that are nearest to the other one in some direction.
struct Cap {
  static constexpr size_t kMost = 32;

  std::array<Place, kMost> place;
  std::array<float, kMost> along;
  std::array<tree::WideTree::Node, kMost / kWidth> boxes;
  size_t count = 0;

  void add(const Place& leaf, float extent, const tree::FloatBox& box) {
    tree::WideTree::Node& group = boxes[count / kWidth];
    for (int k = 0; k < 3; ++k) {
      group.lower[k][count % kWidth] = box.lower[k];
      group.upper[k][count % kWidth] = box.upper[k];
    }
    place[count] = leaf;
    along[count] = extent;
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

// Stays beside tree::visit_pairs(): leaves are collected from one tree at a time and paired by their extents
// along one direction, eight at a time, so that hardly any pair of nodes is opened.
class Caps {
 public:
  Caps(const Surfaces& surfaces, ClosestFaces& closest, PairWorkspace& workspace)
      : s_(surfaces), closest_(closest), w_(workspace) {}

  // If a plane across the direction separates the surfaces, adds the pairs of faces or of leaves that may be
  // closest, without opening a pair of nodes. Returns whether it did. compare(pair): compares two leaves.
  template <class Compare>
  bool pair(const Compare& compare) {
    if (!closest_.direction().known) return false;
    Place first[2];
    float along[2];
    if (!separated(first, along)) return false;
    if (!closest_.found() && !(extent(along[0], along[1]) > closest_.limit())) {
      // The two leaves that are nearest to the plane give a bound and a better direction.
      compare(PairWorkspace::Entry{.place = {first[0], first[1]}});
      closest_.compare();
      if (!separated(first, along)) return false;
    }
    if (extent(along[0], along[1]) > closest_.limit()) return true;
    for (int side = 0; side < 2; ++side)
      if (!collect_cap(side, along[1 - side])) return false;
    if (collect_faces(0, along[1]) && collect_faces(1, along[0]))
      pair_faces();
    else
      pair_leaves();
    return true;
  }

 private:
  // Sets the first leaf of each surface and where it begins.
  bool separated(Place (&first)[2], float (&along)[2]) {
    for (int side = 0; side < 2; ++side) along[side] = find_first(side, first[side]);
    return extent(along[0], along[1]) > 0;
  }
  float extent(float along1, float along2) const { return s_.extent(closest_.direction(), along1, along2); }
  // The largest extent of a surface that is not too far, given that of the other one.
  float most_along(float rest) const {
    return closest_.limit() / s_.maps.unit[0] - rest + 2 * s_.maps.to[0].error;
  }

  // Lower bounds on x·u over the boxes of the children.
  HWY_INLINE Vec along_children(int side, const tree::WideTree::Node& node, size_t i) const {
    const Lanes d;
    Vec least = hn::Zero(d);
    for (int k = 0; k < 3; ++k) {
      const float u = closest_.direction().along[side][k];
      least = hn::MulAdd(hn::Set(d, u), hn::Load(d, (u > 0 ? node.lower : node.upper)[k] + i), least);
    }
    return least;
  }

  // The smallest lower bound on x·u over the leaves, and the leaf that has it.
  HWY_NOINLINE float find_first(int side, Place& first) {
    float least = std::numeric_limits<float>::infinity();
    visit_leaves(
        side, [&] { return least; },
        [&](const PairWorkspace::Ahead& leaf) HWY_ATTR {
          const float along =
              least_along(s_.sites[side]->regions, leaf.leaf_number(), closest_.direction().along[side]);
          if (along < least) {
            least = along;
            first = leaf;
          }
        });
    return least;
  }

  // The leaves that are not too far, given that the other surface extends to `along`. Returns false if there
  // are too many.
  HWY_NOINLINE bool collect_cap(int side, float along) {
    Cap& cap = caps_[side];
    cap.count = 0;
    const float most =
        closest_.limit() / s_.maps.unit[0] - along - closest_.direction().offset + 2 * s_.maps.to[0].error;
    return visit_leaves(
        side, [&] { return most; },
        [&](const PairWorkspace::Ahead& leaf) HWY_ATTR {
          const float mine =
              least_along(s_.sites[side]->regions, leaf.leaf_number(), closest_.direction().along[side]);
          if (extent(mine, along) > closest_.limit()) return true;
          if (cap.count == Cap::kMost) return false;
          cap.add(leaf, mine, s_.box_of(leaf, side));
          return true;
        });
  }

  // Visits the leaves whose boxes are not beyond most(), the first ones first.
  template <class Most, class Leaf>
  HWY_INLINE bool visit_leaves(int side, const Most& most, const Leaf& leaf) {
    const auto bound = [&](const PairWorkspace::Ahead&, const tree::WideTree::Node& node,
                           float(&along)[kWidth]) HWY_ATTR {
      const Lanes d;
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
        hn::Store(along_children(side, node, i), d, along + i);
      return children_within(node, along, most());
    };
    const auto enter = [&](const PairWorkspace::Ahead& next) { return next.bound <= most(); };
    return tree::visit(s_.sites[side]->wide, w_.ahead, tree::NearestFirst{bound, enter, leaf});
  }

  // The faces of a cap that are not too far, given that the other surface begins at `along`. Returns false if
  // there are too many.
  bool collect_faces(int side, float along) {
    const Lanes d;
    const Cap& cap = caps_[side];
    CapFaces& faces = faces_[side];
    faces.count = 0;
    // O2's faces are moved to O1's frame, in which the direction of either surface is that of O1 or opposite.
    const float sign = side == 0 ? 1.0f : -1.0f, offset = closest_.direction().offset;
    Vec axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = hn::Set(d, sign * closest_.direction().along[0][k]);
    const float rest = side == 0 ? along + offset : along;
    const float most = most_along(rest);
    LeafFaces leaf;
    for (size_t n = 0; n < cap.count; ++n) {
      leaf.load(*s_.sites[side], cap.place[n].leaf_number());
      if (side == 1) leaf.move(s_.maps.to[0]);
      alignas(64) float least[kWidth];
      for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
        Vec corner[3][3];
        leaf.corners(i, corner);
        hn::Store(Extent::of(corner, axis).lower, d, least + i);
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
  void pair_faces() {
    const Lanes d;
    const CapFaces &a = faces_[0], &b = faces_[1];
    for (size_t j = 0; j < b.count; ++j) {
      const float most = most_along(b.along[j]);
      for (size_t n = 0; kWidth * n < a.count; ++n) {
        alignas(64) float least[kWidth];
        for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
          const Vec along = hn::Load(d, a.along.data() + kWidth * n + i);
          if (hn::AllTrue(d, hn::Gt(along, hn::Set(d, most))))
            hn::Store(hn::Inf(d), d, least + i);
          else
            hn::Store(s_.in_units(face_distances(a.block[n], i, b.block[j / kWidth],
                                                 static_cast<uint32_t>(j % kWidth), closest_.direction())),
                      d, least + i);
        }
        for (size_t i = 0; i < kWidth && kWidth * n + i < a.count; ++i)
          if (least[i] <= closest_.limit())
            closest_.add({std::max(least[i], 0.0f), a.owner[kWidth * n + i], b.owner[j]});
      }
    }
  }

  void pair_leaves() {
    const Lanes d;
    const Cap &cap1 = caps_[0], &cap2 = caps_[1];
    for (size_t j = 0; j < cap2.count; ++j) {
      const CentredBox box(s_.box_of(cap2.place[j], 1));
      const BoxDistances distances(s_.maps, closest_.direction(), 0, box);
      for (size_t group = 0; kWidth * group < cap1.count; ++group) {
        alignas(64) float least[kWidth];
        for (size_t i = 0; i < kWidth; i += hn::Lanes(d))
          hn::Store(distances(cap1.boxes[group], i), d, least + i);
        for (size_t i = 0; i < kWidth && kWidth * group + i < cap1.count; ++i) {
          const size_t at = kWidth * group + i;
          const float bound = std::max(least[i], extent(cap1.along[at], cap2.along[j]));
          if (bound <= closest_.limit()) w_.apart.push({{cap1.place[at], cap2.place[j]}, bound});
        }
      }
    }
  }

  const Surfaces& s_;
  ClosestFaces& closest_;
  PairWorkspace& w_;
  Cap caps_[2];
  CapFaces faces_[2];
};

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// Tests boxes of one tree, one per lane, against a box of the other. Included once for each set of vector
// instructions.
#if defined(SDM_PROXIMITY_BOX_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_PROXIMITY_BOX_LANES_INL_H
#undef SDM_PROXIMITY_BOX_LANES_INL_H
#else
#define SDM_PROXIMITY_BOX_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cmath>

#include "bodies/pairs/unit_maps.h"
#include "geometry/lanes/vec-inl.h"
#include "tree/wide_tree.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace lanes::HWY_NAMESPACE;

constexpr size_t kWidth = tree::WideTree::kWidth;
using Lanes = hn::CappedTag<float, kWidth>;
using Vec = hn::Vec<Lanes>;

// The distance of boxes from their gaps along three orthogonal axes; if they overlap, minus the smallest
// overlap.
HWY_INLINE Vec distance_of_gaps(Lanes d, const Vec (&gap)[3]) {
  const Vec most = hn::Max(hn::Max(gap[0], gap[1]), gap[2]);
  Vec apart[3];
  for (int k = 0; k < 3; ++k) apart[k] = hn::Max(gap[k], hn::Zero(d));
  return hn::IfThenElse(hn::Gt(most, hn::Zero(d)), hn::Sqrt(dot(apart, apart)), most);
}

struct CentredBox {
  float centre[3], half[3];

  explicit CentredBox(const tree::FloatBox& box) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = 0.5f * (box.lower[k] + box.upper[k]);
      half[k] = 0.5f * (box.upper[k] - box.lower[k]);
    }
  }
  // The bounding box of `box` in another frame, enlarged by the rounding error.
  CentredBox(const CentredBox& box, const FrameMap& map) {
    for (int k = 0; k < 3; ++k) {
      centre[k] = map.offset[k];
      half[k] = map.error;
      for (int j = 0; j < 3; ++j) {
        centre[k] += map.row[k][j] * box.centre[j];
        half[k] += std::abs(map.row[k][j]) * box.half[j];
      }
    }
  }
  [[nodiscard]] float size() const { return half[0] + half[1] + half[2]; }
};

// Lower bounds on the distances of boxes to one box, from axes that may separate them: along the sides of the
// boxes of either tree, and in the direction between the closest points found so far.
class BoxDistances {
 public:
  // Distances of boxes of the tree of `side` to a box of the other tree, in the other tree's frame.
  BoxDistances(const UnitMaps& maps, const Direction& direction, int side, const CentredBox& other)
      : maps_(maps), direction_(direction), side_(side), other_(other), seen_(other, maps.to[side]) {}

  HWY_INLINE Vec operator()(const tree::WideTree::Node& node, size_t i) const {
    const Lanes d;
    const Vec one_half = hn::Set(d, 0.5f);
    Vec centre[3], half[3], gap[3];
    for (int k = 0; k < 3; ++k) {
      const Vec lo = hn::Load(d, node.lower[k] + i), hi = hn::Load(d, node.upper[k] + i);
      centre[k] = hn::Mul(one_half, hn::Add(lo, hi));
      half[k] = hn::Mul(one_half, hn::Sub(hi, lo));
      gap[k] = hn::Sub(hn::Abs(hn::Sub(centre[k], hn::Set(d, seen_.centre[k]))),
                       hn::Add(half[k], hn::Set(d, seen_.half[k])));
    }
    Vec least = hn::Mul(hn::Set(d, maps_.unit[side_]), distance_of_gaps(d, gap));
    if (maps_.aligned) return least;
    const FrameMap& map = maps_.to[1 - side_];
    for (int k = 0; k < 3; ++k) {
      const Vec between = hn::Add(dot(d, centre, map.row[k]), hn::Set(d, map.offset[k] - other_.centre[k]));
      const Vec halves = hn::Add(dot_absolute(half, map.row[k]), hn::Set(d, other_.half[k] + map.error));
      gap[k] = hn::Sub(hn::Abs(between), halves);
    }
    least = hn::Max(least, hn::Mul(hn::Set(d, maps_.unit[1 - side_]), distance_of_gaps(d, gap)));
    if (!direction_.known) return least;
    const float(&u)[3] = direction_.along[side_], (&v)[3] = direction_.along[1 - side_];
    float rest = direction_.offset - maps_.to[0].error;
    for (int k = 0; k < 3; ++k) rest += v[k] * other_.centre[k] - std::abs(v[k]) * other_.half[k];
    const Vec along = hn::Add(hn::Sub(dot(d, centre, u), dot_absolute(half, u)), hn::Set(d, rest));
    // How deep boxes overlap does not depend on the direction, so that the order of the search does not
    // either.
    return hn::IfThenElse(hn::Gt(along, hn::Zero(d)),
                          hn::Max(least, hn::Mul(hn::Set(d, maps_.unit[0]), along)), least);
  }

 private:
  static HWY_INLINE Vec dot_absolute(const Vec (&a)[3], const float (&b)[3]) {
    const float absolute[3] = {std::abs(b[0]), std::abs(b[1]), std::abs(b[2])};
    return dot(Lanes(), a, absolute);
  }

  const UnitMaps& maps_;
  const Direction& direction_;
  int side_;
  CentredBox other_, seen_;  // the other box in its own frame, and its bounding box in this one
};

// The children of a node whose bounds are not above the limit, as bits.
HWY_INLINE uint32_t children_within(const tree::WideTree::Node& node, const float (&least)[kWidth],
                                    float limit) {
  const Lanes d;
  uint32_t beyond = 0;
  for (size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, hn::Gt(hn::Load(d, least + i), hn::Set(d, limit)), bytes);
    beyond |= uint32_t{bytes[0]} << i;
  }
  return ~beyond & ((1u << node.count) - 1);
}

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

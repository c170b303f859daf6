#include "query/closest/single_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "query/closest/single_point.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "geometry/lanes/point_triangle-inl.h"
#include "geometry/vec.h"
#include "query/closest/region_kernels-inl.h"
#include "sites/closest_on_face.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {

using namespace lanes::HWY_NAMESPACE;

namespace {

// Finds the faces that may be closest; the policy of its search of the tree.
class SinglePoint {
 public:
  SinglePoint(const sites::SitesData& sites, const Vec3& query, double max_distance,
              SinglePointMemory& memory)
      : sites_(sites), m_(memory) {
    const Vec3 unit = sites.frame.to_unit(query);
    for (int k = 0; k < 3; ++k) point_.centre[k] = static_cast<float>(unit[k]);
    error_ = coordinate_error(point_);
    const float limit =
        static_cast<float>(std::min(1.00001 * max_distance * sites.frame.scale, 1e18)) + error_;
    squared_limit_ = limit * limit;
  }

  void collect() {
    m_.candidates.clear();
    tree::visit(sites_.wide, m_.stack, *this);
  }

  [[nodiscard]] float squared_limit() const { return squared_limit_; }

  static bool before(float first, float second) { return first < second; }
  bool enter(const tree::OpenNode& open) const { return open.bound <= squared_limit_; }
  uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node, float* squared) const {
    const Block d;
    uint32_t near = 0;
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
      const auto from = [&](int k) HWY_ATTR {
        const BlockVec p = hn::Set(d, point_.centre[k]);
        return hn::Sub(p, hn::Min(hn::Max(p, hn::Load(d, node.lo[k] + i)), hn::Load(d, node.hi[k] + i)));
      };
      const BlockVec least = square_norm(d, from(0), from(1), from(2));
      hn::Store(least, d, squared + i);
      near |= bits(hn::Le(least, hn::Set(d, squared_limit_))) << i;
    }
    return near & ((1u << node.count) - 1);
  }

  void leaf(const tree::OpenNode& open_leaf) {
    const Block d;
    const uint32_t leaf = open_leaf.leaf_number();
    const sites::Regions& regions = sites_.regions;
    const uint32_t first = regions.leaves[leaf], count = regions.leaves[leaf + 1] - first;
    uint32_t thin = regions.thin[leaf];
    // Most leaves end here.
    uint32_t open = 0;
    alignas(64) float bound[SiteBlock::kWidth];
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
      const BlockVec least = squared_to_discs(regions.bounds[leaf], thin, i);
      hn::Store(least, d, bound + i);
      open |= bits(hn::Le(least, hn::Set(d, squared_limit_))) << i;
    }
    open &= (1u << count) - 1;
    if (open == 0) return;

    load_corners(first, count);
    alignas(64) float squared[SiteBlock::kWidth];
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d))
      hn::Store(squared_to_faces(thin, i), d, squared + i);
    for (uint32_t rest = open; rest != 0; rest &= rest - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(rest));
      // The distance of a face without a reliable normal is that of its sides, which is only an upper bound.
      const float least = (thin >> i & 1) != 0 ? std::min(squared[i], bound[i]) : squared[i];
      if (!(least <= squared_limit_)) continue;
      m_.candidates.push_back({least, regions.owners[first + i].face});
      const float most = std::sqrt(squared[i]) * 1.00001f + error_;
      squared_limit_ = std::min(squared_limit_, most * most);
    }
  }

 private:
  // Lower bounds on the squared distances of the faces, from the discs that contain them; from balls where
  // the normal may be rounding noise.
  HWY_INLINE BlockVec squared_to_discs(const sites::FaceBounds& bounds, uint32_t thin, size_t i) const {
    const Block d;
    const Vec3Of<BlockVec> r = sub(splat(d, point_.centre), load(d, bounds.centre, i));
    const BlockVec h = hn::IfThenElseZero(hn::Not(lanes_of(thin, i)), dot(r, load(d, bounds.normal, i)));
    const BlockVec squared = dot(r, r), h2 = hn::Mul(h, h);
    // Reduced by the cancellation error in the difference of squares.
    const BlockVec beside =
        hn::Sqrt(hn::Max(hn::NegMulAdd(squared, hn::Set(d, 1e-6f), hn::Sub(squared, h2)), hn::Zero(d)));
    const BlockVec beyond = hn::Max(hn::Sub(beside, hn::Load(d, bounds.radius + i)), hn::Zero(d));
    return hn::MulAdd(beyond, beyond, h2);
  }

  static HWY_INLINE BlockMask lanes_of(uint32_t bits, size_t i) {
    const uint8_t bytes[8] = {static_cast<uint8_t>(bits >> i)};
    return hn::LoadMaskBits(Block(), bytes);
  }

  // Lanes beyond the last face repeat it.
  void load_corners(uint32_t first, uint32_t count) {
    const sites::Regions& regions = sites_.regions;
    for (uint32_t lane = 0; lane < SiteBlock::kWidth; ++lane) {
      const Triangle& corners = regions.places.corners[first + std::min(lane, count - 1)];
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) corner_[c][k][lane] = regions.points[corners[c]].point[k];
    }
  }

  // The squared distances of the faces whose corners are loaded; if they are thin, of their sides. Adds to
  // `thin` those whose smallest height is so small a part of their longest side that their normals are too
  // inaccurate in single precision.
  HWY_INLINE BlockVec squared_to_faces(uint32_t& thin, size_t i) const {
    constexpr float kThin = 3e-5f;
    const Block d;
    const TriangleSides<Block> faces(load(d, corner_[0], i), load(d, corner_[1], i), load(d, corner_[2], i));
    const auto squared = [&](int k) HWY_ATTR { return dot(faces.side[k], faces.side[k]); };
    const BlockVec least = hn::Mul(hn::Set(d, kThin), hn::Max(hn::Max(squared(0), squared(1)), squared(2)));
    thin |= bits(hn::Le(dot(faces.normal, faces.normal), hn::Mul(least, least))) << i;
    return faces.squared_distance(splat(d, point_.centre), hn::Not(lanes_of(thin, i)));
  }

  static HWY_INLINE uint32_t bits(BlockMask mask) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(Block(), mask, bytes);
    return bytes[0];
  }

  const sites::SitesData& sites_;
  SinglePointMemory& m_;
  Ball point_{};                                       // the query in the unit frame
  float error_;                                        // of a distance, by rounding
  float squared_limit_;                                // nothing beyond this in the unit frame is closest
  alignas(64) float corner_[3][3][SiteBlock::kWidth];  // of the faces of a leaf, by corner and axis
};

}  // namespace

// Sets memory.candidates, and returns the bound that those must be within.
float CollectCandidates(const sites::SitesData& sites, const Vec3& query, double max_distance,
                        SinglePointMemory& memory) {
  SinglePoint search(sites, query, max_distance, memory);
  search.collect();
  return search.squared_limit();
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::closest {

HWY_EXPORT(CollectCandidates);

bool is_near(const sites::SitesData& sites, const Vec3& query) {
  constexpr double kNear = 16;
  const Vec3 unit = sites.frame.to_unit(query);
  return std::abs(unit[0]) <= kNear && std::abs(unit[1]) <= kNear && std::abs(unit[2]) <= kNear;
}

ClosestPoint closest_to_point(const sites::SitesData& sites, const Vec3& query, double max_distance,
                              SinglePointMemory& memory) {
  const float most = HWY_DYNAMIC_DISPATCH(CollectCandidates)(sites, query, max_distance, memory);
  ClosestPoint best;
  for (const SinglePointMemory::Candidate& candidate : memory.candidates) {
    if (!(candidate.squared <= most)) continue;
    const ClosestPoint c = sites::closest_on_face(sites, candidate.face, query);
    if (c.distance <= max_distance && c.distance < best.distance) best = c;
  }
  return best;
}

}  // namespace sdm::closest
#endif

#include "engine/cpu/single_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/single_point.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/cpu/region_kernels-inl.h"
#include "geometry/vec.h"
#include "sites/closest_on_face.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::cpu::HWY_NAMESPACE {

// Three coordinates of eight things.
struct BlockVec3 {
  BlockVec x, y, z;
};
HWY_INLINE BlockVec3 sub(const BlockVec3& a, const BlockVec3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE BlockVec dot(const BlockVec3& a, const BlockVec3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE BlockVec3 cross(const BlockVec3& a, const BlockVec3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

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

  // Finds the faces that may be closest.
  void collect() {
    m_.candidates.clear();
    tree::traverse_nearest_child_first(
        sites_.wide, m_.stack,
        [&](const tree::WideTree::Node& node, float* squared)
            HWY_ATTR { return near_children(node, squared); },
        [&](float squared) { return squared <= squared_limit_; },
        [&](uint32_t leaf) HWY_ATTR { visit(leaf); });
  }

  [[nodiscard]] float squared_limit() const { return squared_limit_; }

 private:
  uint32_t near_children(const tree::WideTree::Node& node, float* squared) const {
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

  void visit(uint32_t leaf) {
    const Block d;
    const sites::Regions& regions = sites_.regions;
    const uint32_t first = regions.leaves[leaf], count = regions.leaves[leaf + 1] - first;
    const uint32_t thin = regions.thin[leaf];
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

  // Lower bounds on the squared distances of the faces, from the discs that contain them; from balls where
  // the normal may be rounding noise.
  HWY_INLINE BlockVec squared_to_discs(const sites::FaceBounds& bounds, uint32_t thin, size_t i) const {
    const Block d;
    const auto from = [&](int k) HWY_ATTR {
      return hn::Sub(hn::Set(d, point_.centre[k]), hn::Load(d, bounds.centre[k] + i));
    };
    const BlockVec3 r{from(0), from(1), from(2)};
    const BlockVec h = hn::IfThenElseZero(
        hn::Not(lanes_of(thin, i)),
        dot(r, BlockVec3{hn::Load(d, bounds.normal[0] + i), hn::Load(d, bounds.normal[1] + i),
                         hn::Load(d, bounds.normal[2] + i)}));
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

  // The squared distances of the faces whose corners are loaded; if they are thin, of their sides.
  HWY_INLINE BlockVec squared_to_faces(uint32_t thin, size_t i) const {
    const Block d;
    const auto corner = [&](int c) HWY_ATTR {
      return BlockVec3{hn::Load(d, corner_[c][0] + i), hn::Load(d, corner_[c][1] + i),
                       hn::Load(d, corner_[c][2] + i)};
    };
    const BlockVec3 p{hn::Set(d, point_.centre[0]), hn::Set(d, point_.centre[1]),
                      hn::Set(d, point_.centre[2])};
    const BlockVec3 a = corner(0), b = corner(1), c = corner(2);
    const BlockVec3 side[3] = {sub(b, a), sub(c, b), sub(a, c)}, from[3] = {sub(p, a), sub(p, b), sub(p, c)};
    const BlockVec3 normal = cross(side[0], side[1]);
    BlockVec least = hn::Inf(d);
    BlockMask over = hn::Not(lanes_of(thin, i));
    for (int k = 0; k < 3; ++k) {
      const BlockVec along = dot(from[k], side[k]), length = dot(side[k], side[k]);
      const BlockVec t = hn::IfThenElseZero(hn::Gt(length, hn::Set(d, 1e-30f)),
                                            hn::Div(hn::Min(hn::Max(along, hn::Zero(d)), length), length));
      const BlockVec3 r{hn::NegMulAdd(t, side[k].x, from[k].x), hn::NegMulAdd(t, side[k].y, from[k].y),
                        hn::NegMulAdd(t, side[k].z, from[k].z)};
      least = hn::Min(least, dot(r, r));
      over = hn::And(over, hn::Gt(dot(cross(normal, side[k]), from[k]), hn::Zero(d)));
    }
    const BlockVec height = dot(normal, from[0]), squared = dot(normal, normal);
    return hn::IfThenElse(over, hn::Div(hn::Mul(height, height), squared), least);
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

// Sets memory.candidates, and returns the bound that those must be within.
float CollectCandidates(const sites::SitesData& sites, const Vec3& query, double max_distance,
                        SinglePointMemory& memory) {
  SinglePoint search(sites, query, max_distance, memory);
  search.collect();
  return search.squared_limit();
}

}  // namespace sdm::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::cpu {

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

}  // namespace sdm::cpu
#endif

// Distances from the faces of a leaf in single precision, with bounds on their errors. Included once for each
// set of vector instructions.
#if defined(SDM_FACE_DISTANCES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_FACE_DISTANCES_INL_H
#undef SDM_FACE_DISTANCES_INL_H
#else
#define SDM_FACE_DISTANCES_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "closest/region_kernels-inl.h"
#include "geometry/lanes/vec-inl.h"
#include "sites/face_frames.h"
#include "sites/sites_data.h"

#ifndef SDM_FACE_DISTANCES_ONCE
#define SDM_FACE_DISTANCES_ONCE
namespace sdm::closest {
namespace {

inline sites::FrameSource frame_source(const sites::SitesData& sites) {
  static_assert(sites::FaceFrames::kWidth == sites::FaceBounds::kWidth);
  return {sites.mesh.positions, sites.mesh.triangles, sites.frame, sites.tree.items, sites.regions.leaves};
}

// Whether single precision resolves the point well enough to select faces near it: it is within a few sizes
// of O2.
inline bool is_near(const Vec3& unit_point) {
  constexpr double kNear = 16;
  return std::abs(unit_point[0]) <= kNear && std::abs(unit_point[1]) <= kNear &&
         std::abs(unit_point[2]) <= kNear;
}

// A face of which another one is not closer in double precision is at most kFarther f + distance_error() away
// in single precision, if the other one is at f. With u = 2⁻²⁴, m the largest coordinate of the point (at
// least 1) and R the radius of the largest disc around a face: the point is rounded by √3 u m, the origin of
// a frame by √3 u; with r the vector between them, each of its three coordinates in the frame by 7 u |r|, and
// those relative to a side by as much again. This is less than 1e-6 |r| + 2.1e-7 m, where |r| ≤ f + 2 R. In
// double precision, the normals of all but slivers are accurate to 1e-7, and a sliver is as close as its
// sides to 2e-9 R. Twice the sum, rounded up.
constexpr float kFarther = 1 + 3e-6f;
inline float distance_error(float m, float largest_radius) {
  return 5e-7f * std::max(1.0f, m) + 5e-6f * largest_radius;
}

}  // namespace
}  // namespace sdm::closest
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace {

using namespace lanes::HWY_NAMESPACE;

template <class D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0] | static_cast<uint32_t>(bytes[1]) << 8;
}

// The squared distances of points from boxes, one pair per lane.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V squared_to_boxes(D d, const Vec3Of<V>& p, const Vec3Of<V>& lo, const Vec3Of<V>& hi) {
  return square_norm(d, hn::Sub(p.x, hn::Min(hn::Max(p.x, lo.x), hi.x)),
                     hn::Sub(p.y, hn::Min(hn::Max(p.y, lo.y), hi.y)),
                     hn::Sub(p.z, hn::Min(hn::Max(p.z, lo.z), hi.z)));
}

// Sets the squared distances of the point from the boxes of a node's children; returns, as bits, which of
// them are within the limit.
HWY_INLINE uint32_t near_children(const tree::WideTree::Node& node, const float (&point)[3],
                                  float squared_limit, float* squared) {
  const Block d;
  uint32_t near = 0;
  for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
    const BlockVec least =
        squared_to_boxes(d, splat(d, point), load(d, node.lower, i), load(d, node.upper, i));
    hn::Store(least, d, squared + i);
    near |= bits_of(d, hn::Le(least, hn::Set(d, squared_limit))) << i;
  }
  return near & ((1u << node.count) - 1);
}

// The squared distances of a point from the faces of a leaf; NaN in unused lanes.
HWY_INLINE BlockVec squared_to_faces(const sites::FaceFrames& faces, size_t i, const float (&point)[3]) {
  const Block d;
  const BlockVec zero = hn::Zero(d);
  const Vec3Of<BlockVec> r = sub(splat(d, point), load(d, faces.origin, i));
  const BlockVec u = dot(r, load(d, faces.along, i)), v = dot(r, load(d, faces.beside, i)),
                 h = dot(r, load(d, faces.normal, i)), length = hn::Load(d, faces.length + i);
  const auto beyond = [&](BlockVec t, BlockVec end)
                          HWY_ATTR { return hn::Sub(t, hn::Min(hn::Max(t, zero), end)); };
  // The squared distance in the plane from a side that starts at (u − along, 0); `left`: how far to its left.
  const auto from_side = [&](const sites::FaceFrames::Side& side, BlockVec along, BlockVec& left) HWY_ATTR {
    const BlockVec x = hn::Load(d, side.along + i), y = hn::Load(d, side.beside + i);
    const BlockVec e = beyond(hn::MulAdd(along, x, hn::Mul(v, y)), hn::Load(d, side.length + i));
    left = hn::MulSub(v, x, hn::Mul(along, y));
    return hn::MulAdd(e, e, hn::Mul(left, left));
  };
  const BlockVec e = beyond(u, length);
  BlockVec left_of_ac, left_of_bc;
  const BlockVec from_ac = from_side(faces.ac, u, left_of_ac),
                 from_bc = from_side(faces.bc, hn::Sub(u, length), left_of_bc);
  const BlockVec beside = hn::Min(hn::MulAdd(e, e, hn::Mul(v, v)), hn::Min(from_ac, from_bc));
  const auto over = hn::And(hn::Gt(hn::Min(v, left_of_bc), zero), hn::Lt(left_of_ac, zero));
  return hn::MulAdd(h, h, hn::IfThenElse(over, zero, beside));
}

// Compares the faces of a leaf with a point: calls take(squared, lane) for those that may be closest, after
// it has reduced the squared limit by them. Returns whether it did. Of the faces that are near enough from
// lane i on, keep(i, mask) says which count.
template <class Keep, class Take>
HWY_INLINE bool compare_faces(const sites::FaceFrames& faces, const float (&point)[3], float error,
                              float& squared_limit, const Keep& keep, const Take& take) {
  const Block d;
  bool reduced = false;
  for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
    const BlockVec squared = squared_to_faces(faces, i, point);
    const auto within = keep(i, hn::Le(squared, hn::Set(d, squared_limit)));  // false in unused lanes
    uint32_t near = bits_of(d, within);
    if (near == 0) continue;
    const float least = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(within, squared, hn::Inf(d))));
    const float limit = std::sqrt(least) * kFarther + error;
    if (limit * limit < squared_limit) {
      squared_limit = limit * limit;
      reduced = true;
    }
    alignas(64) float each[SiteBlock::kWidth];
    hn::Store(squared, d, each);
    for (; near != 0; near &= near - 1) {
      const auto lane = static_cast<size_t>(std::countr_zero(near));
      if (each[lane] <= squared_limit) take(each[lane], i + lane);
    }
  }
  return reduced;
}

}  // namespace
}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

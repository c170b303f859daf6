// The faces that may be closest to a point that is many sizes of O2 away, in single precision relative to O2.
// Included once for each set of vector instructions.
#if defined(SDM_FAR_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_FAR_SEARCH_INL_H
#undef SDM_FAR_SEARCH_INL_H
#else
#define SDM_FAR_SEARCH_INL_H
#endif

#include <algorithm>
#include <bit>
#include <limits>
#include <span>
#include <vector>

#include "closest/face_distances-inl.h"
#include "closest/single_point.h"
#include "geometry/vec.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace {

// Distances from afar are nearly the same for all of O2, and single precision does not tell them apart. With
// q the point in the unit frame, D = |q| and n = q / D, the search compares
//   g(x) = (|q − x|² − D²) / 2 D = |x|² / 2 D − n·x
// in their place: a sum over the axes, so that its least value in a box is at the point of the box closest to
// q, as that of distances, and of the size of O2 however far q is. It is convex: in a face, it is less than
// at all corners by at most R² / 2 D, where R is the radius of the smallest ball around the face, at most the
// longest side divided by √3.
//
// The policy of a search of the wide tree, the child with the least bound first.
class FarSearch {
 public:
  // Beyond this, double precision does not resolve distances to faces either.
  static constexpr double kFarthest = 1e6;

  FarSearch(sites::LeafFrames::View& frames, const Vec3& unit_point,
            std::vector<SinglePointMemory::Candidate>& candidates)
      : frames_(frames), candidates_(candidates) {
    const double distance = norm(unit_point);
    for (int k = 0; k < 3; ++k) {
      point_[k] = static_cast<float>(unit_point[k]);
      direction_[k] = static_cast<float>(unit_point[k] / distance);
    }
    weight_ = static_cast<float>(0.5 / distance);
  }

  // Reduces the limit by points of O2, in the unit frame.
  void start_from(std::span<const float[3]> points) {
    for (const float(&x)[3] : points) {
      float sum = 0;
      for (int k = 0; k < 3; ++k) sum += x[k] * (x[k] * weight_ - direction_[k]);
      limit_ = std::min(limit_, sum + kError);
    }
  }
  // No face with a larger bound is closest.
  [[nodiscard]] const float& limit() const { return limit_; }

  static bool before(float first, float second) { return first < second; }
  // The root has no bound.
  bool enter(const tree::OpenNode& open) const { return open.bound <= limit_ || open.child == 0; }
  uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node, float* bounds) const {
    const Block d;
    uint32_t near = 0;
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
      const Vec3Of<BlockVec> q = splat(d, point_), lo = load(d, node.lower, i), hi = load(d, node.upper, i);
      const BlockVec least =
          relative_distance({hn::Min(hn::Max(q.x, lo.x), hi.x), hn::Min(hn::Max(q.y, lo.y), hi.y),
                             hn::Min(hn::Max(q.z, lo.z), hi.z)});
      hn::Store(least, d, bounds + i);
      near |= bits_of(d, hn::Le(least, hn::Set(d, limit_))) << i;
    }
    return near & ((1u << node.count) - 1);
  }
  void leaf(const tree::OpenNode& open) {
    const sites::FaceFrames& faces = frames_[open.leaf_number()];
    const Block d;
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
      const Vec3Of<BlockVec> a = load(d, faces.origin, i), along = load(d, faces.along, i),
                             beside = load(d, faces.beside, i);
      const BlockVec length = hn::Load(d, faces.length + i), to_c = hn::Load(d, faces.ac.length + i);
      const BlockVec x = hn::Mul(to_c, hn::Load(d, faces.ac.along + i)),
                     y = hn::Mul(to_c, hn::Load(d, faces.ac.beside + i));
      const BlockVec at_corner =
          hn::Min(relative_distance(a), hn::Min(relative_distance(add_mul(a, length, along)),
                                                relative_distance(add_mul(add_mul(a, x, along), y, beside))));
      const BlockVec least =
          hn::NegMulAdd(hn::Mul(length, length), hn::Set(d, weight_ * (1.0F / 3)), at_corner);
      const auto within = hn::Le(least, hn::Set(d, limit_));  // false in unused lanes
      uint32_t near = bits_of(d, within);
      if (near == 0) continue;
      const float closest = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(within, at_corner, hn::Inf(d))));
      limit_ = std::min(limit_, closest + kError);
      alignas(64) float each[SiteBlock::kWidth];
      hn::Store(least, d, each);
      for (; near != 0; near &= near - 1) {
        const auto lane = static_cast<size_t>(std::countr_zero(near));
        if (each[lane] <= limit_)
          candidates_.push_back({each[lane], faces.face[i + lane], open.leaf_number(), 0});
      }
    }
  }

 private:
  // The error of n·x. With u = 2⁻²⁴, a corner from the frame of its face is off by 32 u at most, n by u, and
  // the sum by 8 u; both faces that are compared are, as a side may be 2 √3 long. Distances in double
  // precision are off by 4e-7 at most, where a face has a normal that is accurate to 1e-7. Together less than
  // 6e-6.
  static constexpr float kError = 1e-5F;

  [[nodiscard]] HWY_INLINE BlockVec relative_distance(const Vec3Of<BlockVec>& x) const {
    const Block d;
    const Vec3Of<BlockVec> n = splat(d, direction_);
    const BlockVec w = hn::Set(d, weight_);
    return hn::MulAdd(x.x, hn::MulSub(x.x, w, n.x),
                      hn::MulAdd(x.y, hn::MulSub(x.y, w, n.y), hn::Mul(x.z, hn::MulSub(x.z, w, n.z))));
  }

  sites::LeafFrames::View& frames_;
  std::vector<SinglePointMemory::Candidate>& candidates_;
  float point_[3], direction_[3], weight_;
  float limit_ = std::numeric_limits<float>::infinity();
};

}  // namespace
}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

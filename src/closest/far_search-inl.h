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
// With u = 2⁻²⁴, a corner from the frame of its face is off by 32 u at most, n by u, and the sum by 8 u; both
// faces that are compared are, as a side may be 2 √3 long. Distances in double precision are off by 4e-7 at
// most, where a face has a normal that is accurate to 1e-7. Together less than 6e-6.
constexpr float kFarError = 1e-5F;
// Beyond this, double precision does not resolve distances to faces either.
constexpr double kFarthest = 1e6;

// g.
template <class V>
HWY_INLINE V relative_distance(const Vec3Of<V>& x, const Vec3Of<V>& n, V weight) {
  return hn::MulAdd(
      x.x, hn::MulSub(x.x, weight, n.x),
      hn::MulAdd(x.y, hn::MulSub(x.y, weight, n.y), hn::Mul(x.z, hn::MulSub(x.z, weight, n.z))));
}

// Compares the faces of a leaf with a point: calls take(bound, lane) for those that may be closest, after it
// has reduced the limit by them. Returns whether it did.
template <class Take>
HWY_INLINE bool compare_far_faces(const sites::FaceFrames& faces, const float (&direction)[3], float weight,
                                  float& limit, const Take& take) {
  const Block d;
  const Vec3Of<BlockVec> n = splat(d, direction);
  const BlockVec w = hn::Set(d, weight);
  bool reduced = false;
  for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
    const Vec3Of<BlockVec> a = load(d, faces.origin, i), along = load(d, faces.along, i),
                           beside = load(d, faces.beside, i);
    const BlockVec length = hn::Load(d, faces.length + i), to_c = hn::Load(d, faces.ac.length + i);
    const BlockVec x = hn::Mul(to_c, hn::Load(d, faces.ac.along + i)),
                   y = hn::Mul(to_c, hn::Load(d, faces.ac.beside + i));
    const BlockVec at_corner =
        hn::Min(relative_distance(a, n, w),
                hn::Min(relative_distance(add_mul(a, length, along), n, w),
                        relative_distance(add_mul(add_mul(a, x, along), y, beside), n, w)));
    const BlockVec least = hn::NegMulAdd(hn::Mul(length, length), hn::Set(d, weight * (1.0F / 3)), at_corner);
    const auto within = hn::Le(least, hn::Set(d, limit));  // false in unused lanes
    uint32_t near = bits_of(d, within);
    if (near == 0) continue;
    const float closest = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(within, at_corner, hn::Inf(d))));
    if (closest + kFarError < limit) {
      limit = closest + kFarError;
      reduced = true;
    }
    alignas(64) float each[SiteBlock::kWidth];
    hn::Store(least, d, each);
    for (; near != 0; near &= near - 1) {
      const auto lane = static_cast<size_t>(std::countr_zero(near));
      if (each[lane] <= limit) take(each[lane], i + lane);
    }
  }
  return reduced;
}

// The policy of a search of the wide tree, the child with the least bound first.
class FarSearch {
 public:
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
      limit_ = std::min(limit_, sum + kFarError);
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
                             hn::Min(hn::Max(q.z, lo.z), hi.z)},
                            splat(d, direction_), hn::Set(d, weight_));
      hn::Store(least, d, bounds + i);
      near |= bits_of(d, hn::Le(least, hn::Set(d, limit_))) << i;
    }
    return near & ((1u << node.count) - 1);
  }
  void leaf(const tree::OpenNode& open) {
    const sites::FaceFrames& faces = frames_[open.leaf_number()];
    compare_far_faces(faces, direction_, weight_, limit_, [&](float bound, size_t lane) {
      candidates_.push_back({bound, faces.face[lane], open.leaf_number(), 0});
    });
  }

 private:
  sites::LeafFrames::View& frames_;
  std::vector<SinglePointMemory::Candidate>& candidates_;
  float point_[3], direction_[3], weight_;
  float limit_ = std::numeric_limits<float>::infinity();
};

// The same for a packet of points. A box is compared with all directions and distances between those of the
// points first, and then with each point.
class FarPacketSearch {
 public:
  static constexpr size_t kSize = SinglePointMemory::kPacket;

  // `far`: the points of the packet that are searched, as bits; at least one.
  FarPacketSearch(sites::LeafFrames::View& frames, std::span<const Vec3> unit_points, uint32_t far,
                  std::vector<SinglePointMemory::Candidate>& candidates)
      : frames_(frames), candidates_(candidates), used_(far) {
    std::fill_n(least_direction_, 3, std::numeric_limits<float>::infinity());
    std::fill_n(most_direction_, 3, -std::numeric_limits<float>::infinity());
    const auto first = static_cast<size_t>(std::countr_zero(far));
    for (size_t i = 0; i < kSize; ++i) {
      const bool used = (far >> i & 1) != 0;
      const Vec3& unit = unit_points[used ? i : first];
      const double distance = norm(unit);
      for (size_t k = 0; k < 3; ++k) {
        point_[k][i] = static_cast<float>(unit[k]);
        direction_[k][i] = static_cast<float>(unit[k] / distance);
        least_direction_[k] = std::min(least_direction_[k], direction_[k][i]);
        most_direction_[k] = std::max(most_direction_[k], direction_[k][i]);
      }
      weight_[i] = static_cast<float>(0.5 / distance);
      least_weight_ = std::min(least_weight_, weight_[i]);
      limit_[i] = used ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity();
    }
  }

  // Reduces the limits by points of O2, in the unit frame.
  void start_from(std::span<const float[3]> points) {
    const Points d;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      PointVec limit = hn::Load(d, limit_ + i);
      for (const float(&x)[3] : points)
        limit = hn::Min(
            limit, hn::Add(relative_distance(splat(d, x), load(d, direction_, i), hn::Load(d, weight_ + i)),
                           hn::Set(d, kFarError)));
      hn::Store(limit, d, limit_ + i);
    }
    find_limit();
  }
  // No face with a larger bound is closest.
  [[nodiscard]] const float* limits() const { return limit_; }

  using Open = SinglePointMemory::Open;
  static bool before(float first, float second) { return first < second; }
  bool enter(const Open& open) {
    near_ = used_;
    if (open.above == nullptr) return true;
    if (!(open.bound <= largest_limit_)) return false;
    const Points d;
    near_ = 0;
    for (size_t i = 0; i < kSize; i += hn::Lanes(d)) {
      const Vec3Of<PointVec> q = load(d, point_, i);
      const auto clamped = [&](PointVec x, const float(&lower)[tree::WideTree::kWidth],
                               const float(&upper)[tree::WideTree::kWidth]) HWY_ATTR {
        return hn::Min(hn::Max(x, hn::Set(d, lower[open.slot])), hn::Set(d, upper[open.slot]));
      };
      const PointVec least =
          relative_distance(Vec3Of<PointVec>{clamped(q.x, open.above->lower[0], open.above->upper[0]),
                                             clamped(q.y, open.above->lower[1], open.above->upper[1]),
                                             clamped(q.z, open.above->lower[2], open.above->upper[2])},
                            load(d, direction_, i), hn::Load(d, weight_ + i));
      near_ |= bits_of(d, hn::Le(least, hn::Load(d, limit_ + i))) << i;
    }
    return near_ != 0;
  }
  // A lower bound on the relative distance of the points of each box: in each axis, w x² − n x for the least
  // weight w and the directions n between two is at least its least value in the box for one of these two,
  // each at n / 2 w, or the end of the box nearest to it.
  uint32_t bound(const Open&, const tree::WideTree::Node& node, float* bounds) const {
    const Block d;
    const BlockVec w = hn::Set(d, least_weight_);
    uint32_t near = 0;
    for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
      BlockVec sum = hn::Zero(d);
      for (size_t k = 0; k < 3; ++k) {
        const BlockVec lo = hn::Load(d, node.lower[k] + i), hi = hn::Load(d, node.upper[k] + i);
        const auto least = [&](float n) HWY_ATTR {
          const BlockVec x = hn::Min(hn::Max(hn::Set(d, 0.5F * n / least_weight_), lo), hi);
          return hn::Mul(x, hn::MulSub(x, w, hn::Set(d, n)));
        };
        sum = hn::Add(sum, hn::Min(least(least_direction_[k]), least(most_direction_[k])));
      }
      hn::Store(sum, d, bounds + i);
      near |= bits_of(d, hn::Le(sum, hn::Set(d, largest_limit_))) << i;
    }
    return near & ((1u << node.count) - 1);
  }
  void leaf(const Open& open) {
    const sites::FaceFrames& faces = frames_[open.leaf_number()];
    bool reduced = false;
    for (uint32_t near = near_; near != 0; near &= near - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(near));
      const float direction[3] = {direction_[0][i], direction_[1][i], direction_[2][i]};
      reduced |= compare_far_faces(faces, direction, weight_[i], limit_[i], [&](float bound, size_t lane) {
        candidates_.push_back({bound, faces.face[lane], open.leaf_number(), i});
      });
    }
    if (reduced) find_limit();
  }

 private:
  void find_limit() {
    const Points d;
    PointVec most = hn::Load(d, limit_);
    for (size_t i = hn::Lanes(d); i < kSize; i += hn::Lanes(d)) most = hn::Max(most, hn::Load(d, limit_ + i));
    largest_limit_ = hn::GetLane(hn::MaxOfLanes(d, most));
  }

  sites::LeafFrames::View& frames_;
  std::vector<SinglePointMemory::Candidate>& candidates_;
  alignas(64) float point_[3][kSize];
  alignas(64) float direction_[3][kSize];
  alignas(64) float weight_[kSize];
  alignas(64) float limit_[kSize];
  float least_direction_[3], most_direction_[3];
  float least_weight_ = std::numeric_limits<float>::infinity();
  float largest_limit_ = std::numeric_limits<float>::infinity();
  const uint32_t used_;
  uint32_t near_ = 0;  // points, as bits
};

}  // namespace
}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

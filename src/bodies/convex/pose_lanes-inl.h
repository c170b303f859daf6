// A convex solid and another one, in poses of which each is in one lane of vector registers. Included once
// for each set of vector instructions.
#if defined(SDM_POSE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_POSE_LANES_INL_H
#undef SDM_POSE_LANES_INL_H
#else
#define SDM_POSE_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "bodies/convex/pose_packet.h"
#include "geometry/lanes/vec-inl.h"

// Lengths are in units of the size of both bodies, so that no vertex is farther from the centre of its body
// than 1. Errors, of that unit: 4e-7 of vertices and centres, as they are rounded to single precision and
// turned, 1e-6 by the skew of a pose, and 5e-7 · |v| of a product of them with v. kPoseMargin is more than
// all.
#ifndef SDM_POSE_LANES_ONCE
#define SDM_POSE_LANES_ONCE
namespace sdm::convex {

inline constexpr float kPoseMargin = 4e-6F;

/// Poses that are not decided, in units.
struct OpenPoses {
  static constexpr std::size_t kColumns = 21;
  std::size_t count = 0;
  std::array<std::uint8_t, PosePacket::kPoses> pose{};
  /// Rotations by rows, the centre of the body relative to that of the body at rest; what searches have come
  /// to: a point of the difference of the bodies, the last vertex of it, and a point that may be inside both.
  alignas(64) float entry[kColumns][PosePacket::kPoses];
  static constexpr int kTurn = 0, kBetween = 9, kNearest = 12, kLast = 15, kInner = 18;

  /// Keeps those for which keep(i), and some others, too, as it takes longer to move all than to compare
  /// these once more.
  template <class Keep>
  void keep_if(const Keep& keep) {
    constexpr std::size_t kFew = 4;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) kept += keep(i) ? 1 : 0;
    if (kept > 0 && count - kept < kFew) return;
    kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!keep(i)) continue;
      pose[kept] = pose[i];
      for (auto& column : entry) column[kept] = column[i];
      ++kept;
    }
    count = kept;
  }
};

}  // namespace sdm::convex
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::convex::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Floats>;
using LaneMask = hn::Mask<Floats>;
using LaneVec = lanes::HWY_NAMESPACE::Vec3Of<Lanes>;

/// Two convex bodies, one of them in the poses of the lanes.
class PoseLanes {
  // How far inside both a point is looked for, of the heights of planes; and by how much of the way to a
  // plane a point is moved: almost a reflection.
  static constexpr float kInside = 0.999F, kRelaxation = 1.9F;
  static constexpr float kThinnest = 1e-5F;  // the squared sine of an angle

 public:
  PoseLanes(const PosePacket::Data& data, OpenPoses& open, std::size_t first)
      : data_(data), open_(open), first_(first) {
    for (int j = 0; j < 3; ++j) turn_[j] = load(OpenPoses::kTurn + 3 * j);
    between_ = load(OpenPoses::kBetween);
  }

  // Whether a point of the line between the centres is inside both: the part of it in a body is 1 / k long,
  // where k is the largest height of the other centre above a plane of it, relative to that of the plane.
  [[nodiscard]] HWY_INLINE LaneMask overlap_between_centres() {
    const Lanes length = hn::Sqrt(dot(between_, between_));
    const LaneVec back = to_moving(between_);
    const Lanes rest = above(*data_.resting, to_resting(between_), data_.rest_size, length).most;
    const Lanes move = above(*data_.moving, neg(back), data_.moving_size, length).most;
    const Lanes sum_of_both = hn::Add(rest, move);
    const Lanes part = hn::Div(move, hn::Max(sum_of_both, hn::Set(d_, 1e-6F)));
    store(OpenPoses::kInner, mul(part, between_));
    return hn::Ge(hn::Mul(hn::Set(d_, 1 - data_.least_inside), sum_of_both), hn::Mul(rest, move));
  }

  // Whether a point is inside both. It is moved to the plane of each body that it is farthest above, and a
  // little beyond (Agmon 1954).
  [[nodiscard]] HWY_INLINE LaneMask overlap_at_inner_point() {
    LaneVec p = load(OpenPoses::kInner);
    const Lanes one = hn::Set(d_, 1), two = hn::Set(d_, 2);
    const Above rest = above(*data_.resting, to_resting(p), data_.rest_size, two);
    const Above move = above(*data_.moving, to_moving(sub(p, between_)), data_.moving_size, two);
    const LaneMask inside = hn::And(hn::Lt(rest.most, one), hn::Lt(move.most, one));
    const LaneVec by_rest = from_resting(down(rest, data_.rest_size)),
                  by_move = posed(down(move, data_.moving_size));
    const LaneMask farther = hn::Gt(move.most, rest.most);
    p = sub(p, choose(farther, by_move, by_rest));
    store(OpenPoses::kInner, p);
    return inside;
  }

  // Gilbert 1966: v is a point of the difference of the bodies, towards the one that is nearest to the
  // origin. A step takes the nearest one of the triangle of v, the farthest point against it, and that of the
  // step before. The bodies are apart if all of the difference is on the side of v.
  [[nodiscard]] HWY_INLINE LaneMask apart() {
    const LaneVec v = load(OpenPoses::kNearest), w = lowest(v);
    const Lanes margin =
        hn::Mul(hn::Set(d_, kPoseMargin), hn::Add(hn::Set(d_, 1), hn::Sqrt(dot(between_, between_))));
    const Lanes height = dot(v, w), squared = dot(v, v);
    store(OpenPoses::kNearest, nearest_of_triangle(v, w, load(OpenPoses::kLast)));
    store(OpenPoses::kLast, w);
    return hn::And(hn::Gt(height, hn::Zero(d_)),
                   hn::Gt(hn::Mul(height, height), hn::Mul(hn::Mul(margin, margin), squared)));
  }

 private:
  [[nodiscard]] HWY_INLINE LaneVec load(int column) const {
    return {hn::Load(d_, open_.entry[column] + first_), hn::Load(d_, open_.entry[column + 1] + first_),
            hn::Load(d_, open_.entry[column + 2] + first_)};
  }
  HWY_INLINE void store(int column, const LaneVec& v) {
    hn::Store(v.x, d_, open_.entry[column] + first_);
    hn::Store(v.y, d_, open_.entry[column + 1] + first_);
    hn::Store(v.z, d_, open_.entry[column + 2] + first_);
  }

  [[nodiscard]] HWY_INLINE LaneVec to_moving(const LaneVec& v) const {
    const auto along = [&](Lanes LaneVec::*k) {
      return hn::MulAdd(turn_[2].*k, v.z, hn::MulAdd(turn_[1].*k, v.y, hn::Mul(turn_[0].*k, v.x)));
    };
    return {along(&LaneVec::x), along(&LaneVec::y), along(&LaneVec::z)};
  }
  [[nodiscard]] HWY_INLINE LaneVec to_resting(const LaneVec& v) const {
    const auto along = [&](const Vec3& row) { return dot({set(row[0]), set(row[1]), set(row[2])}, v); };
    return {along(data_.turn[0]), along(data_.turn[1]), along(data_.turn[2])};
  }
  [[nodiscard]] HWY_INLINE Lanes set(double x) const { return hn::Set(d_, static_cast<float>(x)); }

  [[nodiscard]] HWY_INLINE LaneVec from_resting(const LaneVec& v) const {
    const auto along = [&](int j) {
      return dot({set(data_.turn[0][j]), set(data_.turn[1][j]), set(data_.turn[2][j])}, v);
    };
    return {along(0), along(1), along(2)};
  }
  [[nodiscard]] HWY_INLINE LaneVec posed(const LaneVec& v) const {
    return {dot(turn_[0], v), dot(turn_[1], v), dot(turn_[2], v)};
  }

  // The largest height above a plane, relative to that of the plane: at most, but for `nearly`. A point is
  // inside if it is below 1.
  struct Above {
    Lanes most, nearly;
    LaneVec plane;
  };
  // The largest height of a point u, relative to the centre; `length`: at least that of u. `size`: of the
  // body, in units.
  [[nodiscard]] HWY_INLINE Above above(const ConvexMesh& mesh, const LaneVec& u, float size,
                                       Lanes length) const {
    const hn::RebindToSigned<Floats> di;
    const float *x = mesh.planes[0].data(), *y = mesh.planes[1].data(), *z = mesh.planes[2].data();
    const Lanes scale = hn::Set(d_, 1 / size);
    const LaneVec v = mul(scale, u);
    Lanes most = hn::Zero(d_);
    auto at = hn::Zero(di);
    for (std::size_t i = 0; i < mesh.planes[0].size(); ++i) {
      const Lanes height = dot({hn::Set(d_, x[i]), hn::Set(d_, y[i]), hn::Set(d_, z[i])}, v);
      const auto higher = hn::Gt(height, most);
      most = hn::Max(most, height);
      at = hn::IfThenElse(hn::RebindMask(di, higher), hn::Set(di, static_cast<std::int32_t>(i)), at);
    }
    const double thickness = mesh.inner_radius / mesh.size * size;
    return {hn::MulAdd(length, set(kPoseMargin / thickness), most),
            most,
            {hn::GatherIndex(d_, x, at), hn::GatherIndex(d_, y, at), hn::GatherIndex(d_, z, at)}};
  }
  // The way down from the point to the plane, and a little beyond.
  [[nodiscard]] HWY_INLINE LaneVec down(const Above& above, float size) const {
    const Lanes t =
        hn::Mul(hn::Set(d_, kRelaxation * size),
                hn::Div(hn::Sub(above.nearly, hn::Set(d_, kInside)), dot(above.plane, above.plane)));
    return mul(t, above.plane);
  }

  // The point of the segments from w to v and to u, or of the triangle, that is nearest to the origin.
  [[nodiscard]] HWY_INLINE LaneVec nearest_of_triangle(const LaneVec& v, const LaneVec& w,
                                                       const LaneVec& u) const {
    const Lanes zero = hn::Zero(d_), one = hn::Set(d_, 1), least = hn::Set(d_, 1e-20F);
    const LaneVec a = sub(v, w), b = sub(u, w);
    const Lanes aa = hn::Max(dot(a, a), least), bb = hn::Max(dot(b, b), least), ab = dot(a, b);
    const Lanes wa = hn::Neg(dot(w, a)), wb = hn::Neg(dot(w, b));
    const auto part = [&](Lanes x, Lanes length) { return hn::Min(hn::Max(hn::Div(x, length), zero), one); };
    const LaneVec on_a = add_mul(w, part(wa, aa), a), on_b = add_mul(w, part(wb, bb), b);
    const LaneMask b_nearer = hn::Lt(dot(on_b, on_b), dot(on_a, on_a));
    LaneVec best = choose(b_nearer, on_b, on_a);
    // Weights mean nothing if the triangle is as thin as rounding, such as that of the first step.
    const Lanes thinnest = hn::Mul(hn::Set(d_, kThinnest), hn::Mul(aa, bb));
    const Lanes determinant = hn::Sub(hn::Mul(aa, bb), hn::Mul(ab, ab));
    const Lanes s = hn::Div(hn::Sub(hn::Mul(wa, bb), hn::Mul(wb, ab)), determinant);
    const Lanes t = hn::Div(hn::Sub(hn::Mul(wb, aa), hn::Mul(wa, ab)), determinant);
    const LaneMask within = hn::And(hn::And(hn::Ge(s, zero), hn::Ge(t, zero)),
                                    hn::And(hn::Le(hn::Add(s, t), one), hn::Gt(determinant, thinnest)));
    return choose(within, add_mul(add_mul(w, s, a), t, b), best);
  }
  static HWY_INLINE LaneVec choose(LaneMask which, const LaneVec& a, const LaneVec& b) {
    return {hn::IfThenElse(which, a.x, b.x), hn::IfThenElse(which, a.y, b.y),
            hn::IfThenElse(which, a.z, b.z)};
  }

  // The point of the difference with the least height along v.
  [[nodiscard]] HWY_INLINE LaneVec lowest(const LaneVec& v) const {
    const LaneVec m = to_moving(v);
    const LaneVec rest = from_resting(farthest(*data_.resting, to_resting(v), data_.rest_size));
    const LaneVec move = posed(farthest(*data_.moving, neg(m), data_.moving_size));
    return sub(add(between_, move), rest);
  }
  // The vertex that is farthest along u, in units about the centre.
  [[nodiscard]] HWY_INLINE LaneVec farthest(const ConvexMesh& mesh, const LaneVec& u, float size) const {
    const hn::RebindToSigned<Floats> di;
    const float *x = mesh.along[0].data(), *y = mesh.along[1].data(), *z = mesh.along[2].data();
    Lanes most = hn::Set(d_, -std::numeric_limits<float>::infinity());
    auto at = hn::Zero(di);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const Lanes height = dot({hn::Set(d_, x[i]), hn::Set(d_, y[i]), hn::Set(d_, z[i])}, u);
      const auto higher = hn::Gt(height, most);
      most = hn::Max(most, height);
      at = hn::IfThenElse(hn::RebindMask(di, higher), hn::Set(di, static_cast<std::int32_t>(i)), at);
    }
    return mul(hn::Set(d_, size),
               LaneVec{hn::GatherIndex(d_, x, at), hn::GatherIndex(d_, y, at), hn::GatherIndex(d_, z, at)});
  }

  const PosePacket::Data& data_;
  OpenPoses& open_;
  const std::size_t first_;
  Floats d_;
  LaneVec turn_[3];  // rows
  LaneVec between_;
};

}  // namespace sdm::convex::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

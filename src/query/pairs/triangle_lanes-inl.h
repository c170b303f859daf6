// Distances of pairs of triangles, one pair per lane, in double precision. Included once for each set of
// vector instructions.
#if defined(SDM_PROXIMITY_TRIANGLE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_PROXIMITY_TRIANGLE_LANES_INL_H
#undef SDM_PROXIMITY_TRIANGLE_LANES_INL_H
#else
#define SDM_PROXIMITY_TRIANGLE_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <limits>

#include "geometry/triangle_pair.h"
#include "geometry/vec_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::pairs::HWY_NAMESPACE {
namespace lanes = core::HWY_NAMESPACE;

// The squared distances of triangles that do not intersect, as closest_points() in geometry computes
// them, to rounding: the minimum over all pairs of features.
class TrianglePairs {
 public:
  static constexpr size_t kLanes = lanes::kLanes;

  void set(size_t lane, const Corners& a, const Corners& b) {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) corner_[0][c][k][lane] = a[c][k], corner_[1][c][k][lane] = b[c][k];
  }

  // For the first `count` lanes.
  void squared_distances(size_t count, double (&squared)[kLanes]) const {
    const lanes::Doubles d;
    for (size_t i = 0; i < count; i += hn::Lanes(d)) hn::StoreU(squared_distances(i), d, squared + i);
  }

 private:
  struct Sides {
    lanes::Vec3v corner[3], side[3];
    lanes::Vec inverse_squared[3];  // of sides: 1 / length², or 0
    lanes::Vec3v normal;
    lanes::Vec inverse_normal;  // 1 / |normal|², or 0

    Sides(const double (&corners)[3][3][kLanes], size_t i) {
      const lanes::Doubles d;
      for (int k = 0; k < 3; ++k)
        corner[k] = {hn::Load(d, corners[k][0] + i), hn::Load(d, corners[k][1] + i),
                     hn::Load(d, corners[k][2] + i)};
      for (int k = 0; k < 3; ++k) {
        side[k] = lanes::sub(corner[(k + 1) % 3], corner[k]);
        inverse_squared[k] = inverse(lanes::dot(side[k], side[k]));
      }
      normal = lanes::cross(side[0], side[1]);
      inverse_normal = inverse(lanes::dot(normal, normal));
    }
  };

  static HWY_INLINE lanes::Vec inverse(lanes::Vec x) {
    const lanes::Doubles d;
    const auto least = hn::Set(d, std::numeric_limits<double>::min());
    return hn::IfThenElseZero(hn::Gt(x, least), hn::Div(hn::Set(d, 1.0), hn::Max(x, least)));
  }

  HWY_INLINE lanes::Vec squared_distances(size_t i) const {
    const Sides a(corner_[0], i), b(corner_[1], i);
    lanes::Vec best = hn::Inf(lanes::Doubles());
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        best = hn::Min(best, hn::Min(to_side(a.corner[j], b, k), to_side(b.corner[j], a, k)));
        best = hn::Min(best, crossing(a, j, b, k));
      }
    for (int j = 0; j < 3; ++j)
      best = hn::Min(best, hn::Min(to_interior(a.corner[j], b), to_interior(b.corner[j], a)));
    return best;
  }

  static HWY_INLINE lanes::Vec to_side(const lanes::Vec3v& p, const Sides& t, int k) {
    const lanes::Doubles d;
    const lanes::Vec3v r = lanes::sub(p, t.corner[k]);
    const lanes::Vec s = hn::Min(
        hn::Max(hn::Mul(lanes::dot(r, t.side[k]), t.inverse_squared[k]), hn::Zero(d)), hn::Set(d, 1.0));
    const lanes::Vec3v from = lanes::sub_mul(r, s, t.side[k]);
    return lanes::dot(from, from);
  }

  // Infinite unless the lines are closest between the ends of both sides.
  static HWY_INLINE lanes::Vec crossing(const Sides& a, int j, const Sides& b, int k) {
    const lanes::Doubles d;
    const lanes::Vec zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const lanes::Vec3v n = lanes::cross(a.side[j], b.side[k]), r = lanes::sub(b.corner[k], a.corner[j]);
    const lanes::Vec inverse_squared = inverse(lanes::dot(n, n));
    const lanes::Vec s = hn::Mul(lanes::dot(lanes::cross(r, b.side[k]), n), inverse_squared),
                     t = hn::Mul(lanes::dot(lanes::cross(r, a.side[j]), n), inverse_squared);
    const auto within =
        hn::And(hn::And(hn::Gt(s, zero), hn::Lt(s, one)), hn::And(hn::Gt(t, zero), hn::Lt(t, one)));
    const lanes::Vec3v from = lanes::sub_mul(lanes::add(r, lanes::mul(t, b.side[k])), s, a.side[j]);
    return hn::IfThenElse(within, lanes::dot(from, from), hn::Inf(d));
  }

  // Infinite unless p is above or below the triangle.
  static HWY_INLINE lanes::Vec to_interior(const lanes::Vec3v& p, const Sides& t) {
    const lanes::Doubles d;
    const lanes::Vec zero = hn::Zero(d);
    const lanes::Vec3v r = lanes::sub(p, t.corner[0]), turned = lanes::cross(t.normal, r);
    const lanes::Vec v = hn::Neg(hn::Mul(lanes::dot(turned, t.side[2]), t.inverse_normal)),
                     w = hn::Neg(hn::Mul(lanes::dot(turned, t.side[0]), t.inverse_normal));
    const auto over =
        hn::And(hn::And(hn::Gt(v, zero), hn::Gt(w, zero)), hn::Lt(hn::Add(v, w), hn::Set(d, 1.0)));
    const lanes::Vec3v from = lanes::add(lanes::sub_mul(r, v, t.side[0]), lanes::mul(w, t.side[2]));
    return hn::IfThenElse(over, lanes::dot(from, from), hn::Inf(d));
  }

  alignas(64) double corner_[2][3][3][kLanes] = {};  // of either triangle, by corner and axis
};

}  // namespace sdm::pairs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

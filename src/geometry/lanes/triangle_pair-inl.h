// Distances of pairs of triangles, one pair per lane, in double precision. Included once for each set of
// vector instructions.
#if defined(SDM_LANES_TRIANGLE_PAIR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_LANES_TRIANGLE_PAIR_INL_H
#undef SDM_LANES_TRIANGLE_PAIR_INL_H
#else
#define SDM_LANES_TRIANGLE_PAIR_INL_H
#endif

#include "geometry/lanes/point_triangle-inl.h"
#include "geometry/triangle.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::lanes::HWY_NAMESPACE {

// The squared distances of triangles that do not intersect, as closest_points() computes them, to rounding:
// the minimum over all pairs of features.
class TrianglePairs {
 public:
  static constexpr size_t kLanes = lanes::HWY_NAMESPACE::kLanes;

  void set(size_t lane, const Corners& a, const Corners& b) {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) {
        corner_[0][c][k][lane] = a[c][k];
        corner_[1][c][k][lane] = b[c][k];
      }
  }

  // The squared distances of the first `count` lanes.
  void squared_distances(size_t count, double (&squared)[kLanes]) const {
    const Doubles d;
    for (size_t i = 0; i < count; i += hn::Lanes(d)) hn::StoreU(squared_distances(i), d, squared + i);
  }

 private:
  using Sides = TriangleSides<Doubles>;

  static HWY_INLINE Sides sides(const double (&corner)[3][3][kLanes], size_t i) {
    const Doubles d;
    return {load(d, corner[0], i), load(d, corner[1], i), load(d, corner[2], i)};
  }
  HWY_INLINE Vec squared_distances(size_t i) const {
    const Sides a = sides(corner_[0], i), b = sides(corner_[1], i);
    Vec best = hn::Inf(Doubles());
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) best = hn::Min(best, crossing(a, j, b, k));
      best = hn::Min(best, hn::Min(b.squared_distance(a.corner[j]), a.squared_distance(b.corner[j])));
    }
    return best;
  }

  // Infinite unless the lines are closest between the ends of both sides.
  static HWY_INLINE Vec crossing(const Sides& a, int j, const Sides& b, int k) {
    const Doubles d;
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const Vec3v n = cross(a.side[j], b.side[k]), r = sub(b.corner[k], a.corner[j]);
    const Vec inverse_squared = inverse(dot(n, n));
    const Vec s = hn::Mul(dot(cross(r, b.side[k]), n), inverse_squared),
              t = hn::Mul(dot(cross(r, a.side[j]), n), inverse_squared);
    const auto within =
        hn::And(hn::And(hn::Gt(s, zero), hn::Lt(s, one)), hn::And(hn::Gt(t, zero), hn::Lt(t, one)));
    const Vec3v from = sub_mul(add(r, mul(t, b.side[k])), s, a.side[j]);
    return hn::IfThenElse(within, dot(from, from), hn::Inf(d));
  }

  alignas(64) double corner_[2][3][3][kLanes] = {};  // of either triangle, by corner and axis
};

}  // namespace sdm::lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

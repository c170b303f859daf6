// closest_feature() of geometry/point_triangle.h for pairs of a point and a triangle, one pair per lane, bit
// by bit: the same operations in the same order. A source that includes this is compiled without contraction
// of products and sums (-ffp-contract=off), which would round them differently. Included once for each set of
// vector instructions.
#if defined(SDM_LANES_CLOSEST_FEATURE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_LANES_CLOSEST_FEATURE_INL_H
#undef SDM_LANES_CLOSEST_FEATURE_INL_H
#else
#define SDM_LANES_CLOSEST_FEATURE_INL_H
#endif

#include "geometry/lanes/vec-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::lanes::HWY_NAMESPACE {

// Products and sums that are rounded one by one, as in sdm/types.h.
HWY_INLINE Vec plain_dot(const Vec3v& a, const Vec3v& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec3v plain_cross(const Vec3v& a, const Vec3v& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vec3v if_then_else(hn::Mask<Doubles> mask, const Vec3v& a, const Vec3v& b) {
  return {hn::IfThenElse(mask, a.x, b.x), hn::IfThenElse(mask, a.y, b.y), hn::IfThenElse(mask, a.z, b.z)};
}

// Up to eight pairs.
struct ClosestFeatures {
  // Numbers of features: corners 0 to 2, sides 3 to 5, and the interior.
  static constexpr int kSides = 3, kInterior = 6;

  alignas(64) double query[3][kLanes], corner[3][3][kLanes], flat[kLanes];  // flat: 1 or 0
  alignas(64) double point[3][kLanes], distance[kLanes], feature[kLanes];   // the results

  HWY_INLINE void set(size_t lane, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c, bool is_flat) {
    for (int k = 0; k < 3; ++k) {
      query[k][lane] = q[k];
      corner[0][k][lane] = a[k];
      corner[1][k][lane] = b[k];
      corner[2][k][lane] = c[k];
    }
    flat[lane] = is_flat ? 1 : 0;
  }

  // Computes the first `count` lanes; the others must have been set to something before.
  HWY_INLINE void compute(size_t count) {
    const Doubles d;
    for (size_t i = 0; i < count; i += hn::Lanes(d)) compute_at(i);
  }

 private:
  HWY_INLINE void compute_at(size_t i) {
    const Doubles d;
    const Vec zero = hn::Zero(d);
    const Vec3v q = load(d, query, i);
    const Vec3v corners[3] = {load(d, corner[0], i), load(d, corner[1], i), load(d, corner[2], i)};
    const Vec3v side[3] = {sub(corners[1], corners[0]), sub(corners[2], corners[1]),
                           sub(corners[0], corners[2])};
    const Vec3v from[3] = {sub(q, corners[0]), sub(q, corners[1]), sub(q, corners[2])};
    const Vec3v normal = plain_cross(side[0], side[1]);
    const auto is_flat = hn::Gt(hn::Load(d, flat + i), zero);
    auto over = is_flat;
    Vec best = hn::Inf(d), number = hn::Set(d, double{kInterior});
    Vec3v at{zero, zero, zero};
    for (int k = 0; k < 3; ++k) {
      const auto inner = hn::And(is_flat, hn::Gt(plain_dot(from[k], plain_cross(normal, side[k])), zero));
      over = hn::And(over, inner);
      const Vec along = plain_dot(from[k], side[k]), length = plain_dot(side[k], side[k]);
      const auto before = hn::Le(along, zero), beyond = hn::Ge(along, length);
      const Vec part = hn::Div(along, length);
      const Vec3v on_side{hn::Add(corners[k].x, hn::Mul(part, side[k].x)),
                          hn::Add(corners[k].y, hn::Mul(part, side[k].y)),
                          hn::Add(corners[k].z, hn::Mul(part, side[k].z))};
      const Vec3v found =
          if_then_else(before, corners[k], if_then_else(beyond, corners[(k + 1) % 3], on_side));
      const Vec3v to = sub(found, q);
      const Vec squared = plain_dot(to, to);
      const auto closer = hn::AndNot(inner, hn::Lt(squared, best));
      const Vec here = hn::IfThenElse(
          before, hn::Set(d, double(k)),
          hn::IfThenElse(beyond, hn::Set(d, double((k + 1) % 3)), hn::Set(d, double(kSides + k))));
      best = hn::IfThenElse(closer, squared, best);
      number = hn::IfThenElse(closer, here, number);
      at = if_then_else(closer, found, at);
    }
    const Vec height = hn::Div(plain_dot(from[0], normal), plain_dot(normal, normal));
    const Vec3v foot{hn::Sub(q.x, hn::Mul(height, normal.x)), hn::Sub(q.y, hn::Mul(height, normal.y)),
                     hn::Sub(q.z, hn::Mul(height, normal.z))};
    const Vec3v to_foot = sub(foot, q);
    at = if_then_else(over, foot, at);
    hn::Store(hn::Sqrt(hn::IfThenElse(over, plain_dot(to_foot, to_foot), best)), d, distance + i);
    hn::Store(hn::IfThenElse(over, hn::Set(d, double{kInterior}), number), d, feature + i);
    hn::Store(at.x, d, point[0] + i);
    hn::Store(at.y, d, point[1] + i);
    hn::Store(at.z, d, point[2] + i);
  }
};

}  // namespace sdm::lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

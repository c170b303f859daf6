// Distances of points and triangles, a pair per lane, of any width and precision. Included once for each set
// of vector instructions.
#if defined(SDM_LANES_POINT_TRIANGLE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_LANES_POINT_TRIANGLE_INL_H
#undef SDM_LANES_POINT_TRIANGLE_INL_H
#else
#define SDM_LANES_POINT_TRIANGLE_INL_H
#endif

#include "geometry/lanes/vec-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::lanes::HWY_NAMESPACE {

// Features of triangles of any shape.
template <class D>
struct TriangleSides {
  using V = hn::Vec<D>;
  Vec3Of<V> corner[3], side[3];
  V inverse_squared[3];  // of sides: 1 / length², or 0
  Vec3Of<V> normal;
  V inverse_normal;  // 1 / |normal|², or 0

  HWY_INLINE TriangleSides(const Vec3Of<V>& a, const Vec3Of<V>& b, const Vec3Of<V>& c) : corner{a, b, c} {
    for (int k = 0; k < 3; ++k) {
      side[k] = sub(corner[(k + 1) % 3], corner[k]);
      inverse_squared[k] = inverse(dot(side[k], side[k]));
    }
    normal = cross(side[0], side[1]);
    inverse_normal = inverse(dot(normal, normal));
  }

  // The squared distances from side k.
  HWY_INLINE V to_side(const Vec3Of<V>& p, int k) const {
    const D d;
    const Vec3Of<V> r = sub(p, corner[k]);
    const V s = hn::Min(hn::Max(hn::Mul(dot(r, side[k]), inverse_squared[k]), hn::Zero(d)), hn::Set(d, 1));
    const Vec3Of<V> from = sub_mul(r, s, side[k]);
    return dot(from, from);
  }
  HWY_INLINE V to_sides(const Vec3Of<V>& p) const {
    return hn::Min(hn::Min(to_side(p, 0), to_side(p, 1)), to_side(p, 2));
  }
  // The lanes in which p is above or below the interior; `from`: the vector from the foot of p.
  HWY_INLINE hn::Mask<D> over(const Vec3Of<V>& p, Vec3Of<V>& from) const {
    const D d;
    const Vec3Of<V> r = sub(p, corner[0]), turned = cross(normal, r);
    const V v = hn::Neg(hn::Mul(dot(turned, side[2]), inverse_normal)),
            w = hn::Neg(hn::Mul(dot(turned, side[0]), inverse_normal));
    from = add(sub_mul(r, v, side[0]), mul(w, side[2]));
    return hn::And(hn::And(hn::Gt(v, hn::Zero(d)), hn::Gt(w, hn::Zero(d))),
                   hn::Lt(hn::Add(v, w), hn::Set(d, 1)));
  }

  // The squared distances for any shape: from points of the triangles, so never too small.
  HWY_INLINE V squared_distance(const Vec3Of<V>& p) const {
    Vec3Of<V> from;
    const auto inside = over(p, from);
    return hn::Min(to_sides(p), hn::IfThenElse(inside, dot(from, from), hn::Inf(D())));
  }
  // Where `flat`, the normals are reliable. The foot of p is then inaccurate along the triangle only, by the
  // error of the normal times the distance from corner 0, and this is at a right angle to the normal. Other
  // triangles are represented by their sides.
  HWY_INLINE V squared_distance(const Vec3Of<V>& p, hn::Mask<D> flat) const {
    Vec3Of<V> from;
    const auto inside = hn::And(flat, over(p, from));
    const V height = dot(normal, from);
    return hn::IfThenElse(inside, hn::Mul(hn::Mul(height, inverse_normal), height), to_sides(p));
  }
};

}  // namespace sdm::lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

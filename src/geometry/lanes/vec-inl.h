// Vectors of three numbers, one vector per lane, of any width and precision. Included once for each set of
// vector instructions.
#if defined(SDM_LANES_VEC_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_LANES_VEC_INL_H
#undef SDM_LANES_VEC_INL_H
#else
#define SDM_LANES_VEC_INL_H
#endif

#include <hwy/highway.h>
#include <sdm/types.h>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace sdm::lanes::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Vec3Of {
  V x, y, z;
};

template <class V>
HWY_INLINE Vec3Of<V> add(const Vec3Of<V>& a, const Vec3Of<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3Of<V> sub(const Vec3Of<V>& a, const Vec3Of<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Vec3Of<V> mul(V s, const Vec3Of<V>& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
template <class V>
HWY_INLINE Vec3Of<V> neg(const Vec3Of<V>& a) {
  return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
// a + s b
template <class V>
HWY_INLINE Vec3Of<V> add_mul(const Vec3Of<V>& a, V s, const Vec3Of<V>& b) {
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
// a − s b
template <class V>
HWY_INLINE Vec3Of<V> sub_mul(const Vec3Of<V>& a, V s, const Vec3Of<V>& b) {
  return {hn::NegMulAdd(s, b.x, a.x), hn::NegMulAdd(s, b.y, a.y), hn::NegMulAdd(s, b.z, a.z)};
}
template <class V>
HWY_INLINE V dot(const Vec3Of<V>& a, const Vec3Of<V>& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
template <class V>
HWY_INLINE Vec3Of<V> cross(const Vec3Of<V>& a, const Vec3Of<V>& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
// 1 / x, or 0 where x is 0.
template <class V>
HWY_INLINE V inverse_or_zero(V x) {
  const hn::DFromV<V> d;
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), hn::Div(hn::Set(d, 1), x));
}
// 1 / x, or 0 where x underflows.
template <class V>
HWY_INLINE V inverse(V x) {
  const hn::DFromV<V> d;
  const V least = hn::Set(d, std::numeric_limits<hn::TFromV<V>>::min());
  return hn::IfThenElseZero(hn::Gt(x, least), hn::Div(hn::Set(d, 1), hn::Max(x, least)));
}
template <class V>
HWY_INLINE Vec3Of<V> normalized(const Vec3Of<V>& a) {
  return mul(inverse_or_zero(hn::Sqrt(dot(a, a))), a);
}
// The same vector in every lane.
template <class D, class Coordinates>
HWY_INLINE Vec3Of<hn::Vec<D>> splat(D d, const Coordinates& v) {
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}
template <class D, class T, size_t size>
HWY_INLINE Vec3Of<hn::Vec<D>> load(D d, const T (&rows)[3][size], size_t i) {
  return {hn::Load(d, rows[0] + i), hn::Load(d, rows[1] + i), hn::Load(d, rows[2] + i)};
}

// Vectors whose coordinates are numbered.
template <class V>
HWY_INLINE V dot(const V (&a)[3], const V (&b)[3]) {
  return hn::MulAdd(a[2], b[2], hn::MulAdd(a[1], b[1], hn::Mul(a[0], b[0])));
}
template <class D>
HWY_INLINE hn::Vec<D> dot(D d, const hn::Vec<D> (&a)[3], const hn::TFromD<D> (&b)[3]) {
  return hn::MulAdd(a[2], hn::Set(d, b[2]),
                    hn::MulAdd(a[1], hn::Set(d, b[1]), hn::Mul(a[0], hn::Set(d, b[0]))));
}
template <class D, size_t size>
HWY_INLINE void load(D d, const hn::TFromD<D> (&rows)[3][size], size_t i, hn::Vec<D> (&v)[3]) {
  for (int k = 0; k < 3; ++k) v[k] = hn::Load(d, rows[k] + i);
}

// Eight vectors of doubles, processed together, in one register or several.
constexpr size_t kLanes = 8;
using Doubles = hn::CappedTag<double, kLanes>;
using Vec = hn::Vec<Doubles>;
using Vec3v = Vec3Of<Vec>;

HWY_INLINE Vec3v splat(const Vec3& v) {
  return splat(Doubles(), v);
}

// Vectors that are loaded and stored one lane at a time; initially 0.
struct Vec3Lanes {
  alignas(64) double at[3][kLanes];

  HWY_INLINE Vec3Lanes() {
    const Doubles d;
    for (size_t i = 0; i < 3 * kLanes; i += hn::Lanes(d)) hn::Store(hn::Zero(d), d, at[0] + i);
  }
  HWY_INLINE void set(size_t lane, const Vec3& v) {
    for (int k = 0; k < 3; ++k) at[k][lane] = v[k];
  }
  HWY_INLINE Vec3v load(size_t i) const { return lanes::HWY_NAMESPACE::load(Doubles(), at, i); }
  HWY_INLINE void store(const Vec3v& v, size_t i) {
    const Doubles d;
    hn::Store(v.x, d, at[0] + i);
    hn::Store(v.y, d, at[1] + i);
    hn::Store(v.z, d, at[2] + i);
  }
};

}  // namespace sdm::lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

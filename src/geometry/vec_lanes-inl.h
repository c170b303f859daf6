// Vectors of three doubles, one per lane. Included once for each set of vector instructions.

#if defined(SDM_CORE_VEC_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_CORE_VEC_LANES_INL_H_
#undef SDM_CORE_VEC_LANES_INL_H_
#else
#define SDM_CORE_VEC_LANES_INL_H_
#endif

#include <hwy/highway.h>
#include <sdm/types.h>

HWY_BEFORE_NAMESPACE();
namespace sdm::core::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = 8;  // processed together, in one register or several
using Doubles = hn::CappedTag<double, kLanes>;
using Vec = hn::Vec<Doubles>;

struct Vec3v {
  Vec x, y, z;
};

// The same vector in every lane.
HWY_INLINE Vec3v splat(const Vec3& v) {
  const Doubles d;
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

HWY_INLINE Vec3v add(const Vec3v& a, const Vec3v& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vec3v sub(const Vec3v& a, const Vec3v& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec3v mul(Vec s, const Vec3v& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
// a − s b
HWY_INLINE Vec3v sub_mul(const Vec3v& a, Vec s, const Vec3v& b) {
  return {hn::NegMulAdd(s, b.x, a.x), hn::NegMulAdd(s, b.y, a.y), hn::NegMulAdd(s, b.z, a.z)};
}
HWY_INLINE Vec dot(const Vec3v& a, const Vec3v& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE Vec3v cross(const Vec3v& a, const Vec3v& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
// 1 / x, or 0 where x is 0.
HWY_INLINE Vec inverse_or_zero(Vec x) {
  const Doubles d;
  return hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), hn::Div(hn::Set(d, 1.0), x));
}
HWY_INLINE Vec3v normalized(const Vec3v& a) {
  return mul(inverse_or_zero(hn::Sqrt(dot(a, a))), a);
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
  HWY_INLINE Vec3v load(size_t i) const {
    const Doubles d;
    return {hn::Load(d, at[0] + i), hn::Load(d, at[1] + i), hn::Load(d, at[2] + i)};
  }
  HWY_INLINE void store(const Vec3v& v, size_t i) {
    const Doubles d;
    hn::Store(v.x, d, at[0] + i);
    hn::Store(v.y, d, at[1] + i);
    hn::Store(v.z, d, at[2] + i);
  }
};

}  // namespace sdm::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// The value of expansions, one per lane. Included once for each set of vector instructions.
#if defined(SDM_EXPANSIONS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_EXPANSIONS_INL_H
#undef SDM_EXPANSIONS_INL_H
#else
#define SDM_EXPANSIONS_INL_H
#endif

#include <hwy/highway.h>

#include "geometry/lanes/vec-inl.h"
#include "inside/angles/expansions.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::inside::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using ChildFloats = hn::CappedTag<float, Expansions::kWidth>;
using ChildVec = hn::Vec<ChildFloats>;

/// The values of the children from i on at r = c − q, whose squared length and 1/|r|³ are given.
HWY_INLINE ChildVec expansion_value(const Expansions& e, size_t i, const ChildVec (&r)[3], ChildVec squared,
                                    ChildVec inverse) {
  const ChildFloats d;
  const auto of = [&](int k) HWY_ATTR { return hn::Load(d, e.first[k] + i); };
  const auto two = hn::Set(d, 2);
  const auto x = hn::MulAdd(of(0), r[0], hn::Mul(two, hn::Mul(of(3), r[1])));
  const auto y = hn::MulAdd(of(1), r[1], hn::Mul(two, hn::Mul(of(4), r[2])));
  const auto z = hn::MulAdd(of(2), r[2], hn::Mul(two, hn::Mul(of(5), r[0])));
  const auto along = hn::MulAdd(r[2], z, hn::MulAdd(r[1], y, hn::Mul(r[0], x)));
  ChildVec moment[3];
  lanes::HWY_NAMESPACE::load(d, e.moment, i, moment);
  const auto trace = hn::Add(hn::Add(of(0), of(1)), of(2));
  const auto sum = hn::NegMulAdd(hn::Set(d, 3), hn::Div(along, squared),
                                 hn::Add(lanes::HWY_NAMESPACE::dot(moment, r), trace));
  return hn::Mul(inverse, sum);
}

}  // namespace sdm::inside::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

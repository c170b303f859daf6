#include "research/fields/draw_span.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "research/fields/draw_span.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <sdm/types.h>

HWY_BEFORE_NAMESPACE();
namespace sdm::fields::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using FloatVec = hn::Vec<Floats>;

// The squared length of the vector at points i, i + 1, ...
HWY_INLINE FloatVec squared_length(Floats d, const SpanVector& v, FloatVec i) {
  const FloatVec x = hn::MulAdd(i, hn::Set(d, v.step[0]), hn::Set(d, v.start[0]));
  const FloatVec y = hn::MulAdd(i, hn::Set(d, v.step[1]), hn::Set(d, v.start[1]));
  const FloatVec z = hn::MulAdd(i, hn::Set(d, v.step[2]), hn::Set(d, v.start[2]));
  return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}

void DrawSpan(float* squared, uint32_t* winner, size_t count, const SpanVector& vector, uint32_t site) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> du;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const FloatVec s = squared_length(d, vector, hn::Iota(d, static_cast<float>(i)));
    const FloatVec least = hn::LoadU(d, squared + i);
    const auto closer = hn::And(hn::Lt(s, least), hn::FirstN(d, count - i));
    if (hn::AllFalse(d, closer)) continue;
    hn::StoreU(hn::IfThenElse(closer, s, least), d, squared + i);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(du, closer), hn::Set(du, site), hn::LoadU(du, winner + i)), du,
               winner + i);
  }
}

bool ComesWithin(const float* squared, size_t count, const SpanVector& vector, float reach) {
  const Floats d;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const FloatVec s = squared_length(d, vector, hn::Iota(d, static_cast<float>(i)));
    const FloatVec far = hn::Add(hn::Sqrt(hn::LoadU(d, squared + i)), hn::Set(d, reach));
    if (!hn::AllFalse(d, hn::And(hn::Le(s, hn::Mul(far, far)), hn::FirstN(d, count - i)))) return true;
  }
  return false;
}

}  // namespace sdm::fields::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::fields {

HWY_EXPORT(DrawSpan);
HWY_EXPORT(ComesWithin);

void DepthRows::reset(std::size_t width, std::size_t rows, float value) {
  stride = width + kPadding;
  squared.assign(stride * rows, value);
  winner.assign(stride * rows, kNone);
}

void draw_span(float* squared, std::uint32_t* winner, std::size_t count, const SpanVector& vector,
               std::uint32_t site) {
  HWY_DYNAMIC_DISPATCH(DrawSpan)(squared, winner, count, vector, site);
}

bool comes_within(const float* squared, std::size_t count, const SpanVector& vector, float reach) {
  return HWY_DYNAMIC_DISPATCH(ComesWithin)(squared, count, vector, reach);
}

}  // namespace sdm::fields
#endif

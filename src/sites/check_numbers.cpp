#include "sites/check_numbers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sites/check_numbers.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <bit>
#include <cstring>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace sdm::sites::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The bits of positive numbers have the order of the numbers; those of infinity and NaN are larger than those
// of all others. The limit, less the bits without the sign, is negative only where a number is beyond it, and
// does not overflow.
template <class D>
HWY_INLINE hn::Vec<D> Beyond(D, hn::Vec<D> bits, hn::Vec<D> limit) {
  const D d;
  return hn::Sub(limit, hn::And(bits, hn::Set(d, std::numeric_limits<hn::TFromD<D>>::max())));
}

// Records of 16 words, each with a limit of its own.
bool AreLimited(const int32_t* words, size_t records, const int32_t* limits) {
  const hn::CappedTag<int32_t, 16> d;
  auto beyond = hn::Zero(d);
  for (size_t i = 0; i < records; ++i)
    for (size_t k = 0; k < 16; k += hn::Lanes(d))
      beyond = hn::Or(beyond, Beyond(d, hn::LoadU(d, words + 16 * i + k), hn::LoadU(d, limits + k)));
  return hn::AllFalse(d, hn::Lt(beyond, hn::Zero(d)));
}

template <class Integer>
HWY_INLINE bool AreWithin(const Integer* bits, size_t count, Integer limit) {
  const hn::CappedTag<Integer, 16> d;
  auto beyond = hn::Zero(d);
  size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d))
    beyond = hn::Or(beyond, Beyond(d, hn::LoadU(d, bits + i), hn::Set(d, limit)));
  Integer rest = 0;
  for (; i < count; ++i) rest |= limit - (bits[i] & std::numeric_limits<Integer>::max());
  return rest >= 0 && hn::AllFalse(d, hn::Lt(beyond, hn::Zero(d)));
}
bool AreFloatsWithin(const int32_t* bits, size_t count, int32_t limit) {
  return AreWithin(bits, count, limit);
}
bool AreDoublesWithin(const int64_t* bits, size_t count, int64_t limit) {
  return AreWithin(bits, count, limit);
}

bool HaveLimits(const FaceBounds& bounds, size_t count, float largest_radius) {
  const hn::CappedTag<float, FaceBounds::kWidth> d;
  const auto reach = hn::Set(d, kUnitReach), unit = hn::Set(d, 1.001f), zero = hn::Zero(d);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto radius = hn::Load(d, bounds.radius + i), slope = hn::Load(d, bounds.slope + i);
    auto valid = hn::And(hn::And(hn::Ge(radius, zero), hn::Le(radius, hn::Set(d, largest_radius))),
                         hn::And(hn::Ge(slope, zero), hn::Le(slope, hn::Set(d, FaceBounds::kOpen))));
    for (int k = 0; k < 3; ++k) {
      valid = hn::And(valid, hn::Le(hn::Abs(hn::Load(d, bounds.centre[k] + i)), reach));
      valid = hn::And(valid, hn::Le(hn::Abs(hn::Load(d, bounds.normal[k] + i)), unit));
    }
    if (!hn::AllTrue(d, hn::Or(valid, hn::Not(hn::FirstN(d, count - i))))) return false;
  }
  return true;
}

bool Contains(const double* box, const Triangle* triangles, size_t count, const PaddedPoint* points) {
  const hn::CappedTag<double, 4> d;
  for (size_t k = 0; k < 4; k += hn::Lanes(d)) {
    auto lo = hn::Set(d, std::numeric_limits<double>::infinity()), hi = hn::Neg(lo);
    for (size_t i = 0; i < count; ++i)
      for (const std::uint32_t corner : triangles[i]) {
        const auto p = hn::LoadU(d, points[corner].data() + k);
        lo = hn::Min(lo, p);
        hi = hn::Max(hi, p);
      }
    if (!hn::AllTrue(d, hn::And(hn::Le(hn::LoadU(d, box + k), lo), hn::Le(hi, hn::LoadU(d, box + 4 + k)))))
      return false;
  }
  return true;
}

}  // namespace sdm::sites::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sdm::sites {

HWY_EXPORT(AreLimited);
HWY_EXPORT(AreFloatsWithin);
HWY_EXPORT(AreDoublesWithin);
HWY_EXPORT(HaveLimits);
HWY_EXPORT(Contains);

namespace {

constexpr auto kReach = std::bit_cast<std::int32_t>(kUnitReach);
constexpr auto kUnit = std::bit_cast<std::int32_t>(1.001f);
constexpr auto kInfinite = std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity());
constexpr auto kAny = std::numeric_limits<std::int32_t>::max();  // an index

// A normal and an offset, four times; a wall that encloses nothing is infinitely far away.
constexpr std::int32_t kFaceLimits[] = {kUnit, kUnit, kUnit, kReach,    kUnit, kUnit, kUnit, kInfinite,
                                        kUnit, kUnit, kUnit, kInfinite, kUnit, kUnit, kUnit, kInfinite};
// Start, direction, length, two walls and the edge.
constexpr std::int32_t kEdgeLimits[] = {kReach, kReach, kReach, kUnit, kUnit, kUnit, kReach, kUnit,
                                        kUnit,  kUnit,  kReach, kUnit, kUnit, kUnit, kReach, kAny};
// Point, four rays and the vertex.
constexpr std::int32_t kVertexLimits[] = {kReach, kReach, kReach, kUnit, kUnit, kUnit, kUnit, kUnit,
                                          kUnit,  kUnit,  kUnit,  kUnit, kUnit, kUnit, kUnit, kAny};

template <class Record>
bool are_limited(std::span<const Record> records, const std::int32_t (&limits)[16]) {
  static_assert(sizeof(Record) == sizeof limits);
  return HWY_DYNAMIC_DISPATCH(AreLimited)(reinterpret_cast<const std::int32_t*>(records.data()),
                                          records.size(), limits);
}

}  // namespace

bool are_within(std::span<const float> numbers, float limit) {
  return HWY_DYNAMIC_DISPATCH(AreFloatsWithin)(reinterpret_cast<const std::int32_t*>(numbers.data()),
                                               numbers.size(), std::bit_cast<std::int32_t>(limit));
}
bool are_within(std::span<const double> numbers, double limit) {
  return HWY_DYNAMIC_DISPATCH(AreDoublesWithin)(reinterpret_cast<const std::int64_t*>(numbers.data()),
                                                numbers.size(), std::bit_cast<std::int64_t>(limit));
}

bool have_limits(std::span<const FaceRegion> faces) {
  return are_limited(faces, kFaceLimits);
}
bool have_limits(std::span<const EdgeRegion> edges) {
  return are_limited(edges, kEdgeLimits);
}
bool have_limits(std::span<const VertexRegion> vertices) {
  return are_limited(vertices, kVertexLimits);
}

bool have_limits(const FaceBounds& bounds, std::uint32_t count, float largest_radius) {
  return HWY_DYNAMIC_DISPATCH(HaveLimits)(bounds, count, largest_radius);
}

bool contains(const tree::FloatBox& box, std::span<const Triangle> triangles,
              std::span<const PaddedPoint> points) {
  const double padded[] = {box.lo[0], box.lo[1], box.lo[2], 0, box.hi[0], box.hi[1], box.hi[2], 0};
  return HWY_DYNAMIC_DISPATCH(Contains)(padded, triangles.data(), triangles.size(), points.data());
}

}  // namespace sdm::sites
#endif

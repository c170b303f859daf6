#include "sites/check_numbers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sites/check_numbers.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each set of instructions.
#include <hwy/highway.h>

#include <bit>
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

bool HaveLimits(const tree::AabbTree::Node* nodes, const uint32_t* leaves, size_t count,
                const FaceBounds* bounds, float largest_radius) {
  const hn::CappedTag<float, FaceBounds::kWidth> d;
  const auto reach = hn::Set(d, kUnitReach), unit = hn::Set(d, 1.001f), zero = hn::Zero(d),
             most = hn::Set(d, largest_radius), open = hn::Set(d, FaceBounds::kOpen);
  for (size_t leaf = 0; leaf < count; ++leaf, ++bounds)
    for (size_t i = 0, faces = nodes[leaves[leaf]].count; i < faces; i += hn::Lanes(d)) {
      const auto radius = hn::Load(d, bounds->radius + i), slope = hn::Load(d, bounds->slope + i);
      auto valid = hn::And(hn::And(hn::Ge(radius, zero), hn::Le(radius, most)),
                           hn::And(hn::Ge(slope, zero), hn::Le(slope, open)));
      for (int k = 0; k < 3; ++k) {
        valid = hn::And(valid, hn::Le(hn::Abs(hn::Load(d, bounds->centre[k] + i)), reach));
        valid = hn::And(valid, hn::Le(hn::Abs(hn::Load(d, bounds->normal[k] + i)), unit));
      }
      if (!hn::AllTrue(d, hn::Or(valid, hn::Not(hn::FirstN(d, faces - i))))) return false;
    }
  return true;
}

// Records of six words, of which three vectors of at least two lanes hold a whole number.
bool AreBelow(const uint32_t* words, size_t count, const uint32_t (&most)[6]) {
  const hn::CappedTag<uint32_t, 16> d;
  const size_t lanes = hn::Lanes(d), whole = lanes < 2 ? 0 : count / (3 * lanes) * (3 * lanes);
  auto a = hn::Zero(d), b = a, c = a;
  for (size_t i = 0; i < whole; i += 3 * lanes) {
    a = hn::Max(a, hn::LoadU(d, words + i));
    b = hn::Max(b, hn::LoadU(d, words + i + lanes));
    c = hn::Max(c, hn::LoadU(d, words + i + 2 * lanes));
  }
  HWY_ALIGN uint32_t largest[48];
  hn::Store(a, d, largest);
  hn::StoreU(b, d, largest + lanes);
  hn::StoreU(c, d, largest + 2 * lanes);
  bool below = true;
  for (size_t i = 0; i < 3 * lanes; ++i) below &= largest[i] <= most[i % 6];
  for (size_t i = whole; i < count; ++i) below &= words[i] <= most[(i - whole) % 6];
  return below;
}

bool ArePlaced(const UnitFrame& frame, const Vec3* positions, const UnitVertex* points,
               const VertexRegion* regions, size_t count, PaddedPoint* placed) {
  const hn::CappedTag<double, 4> d;
  const hn::Rebind<float, decltype(d)> single;
  const hn::RebindToUnsigned<decltype(single)> bits;
  const auto words = [](const auto& record) { return reinterpret_cast<const float*>(&record); };
  const auto scale = hn::Set(d, frame.scale);
  const double padded[] = {frame.origin[0], frame.origin[1], frame.origin[2], 0};
  for (size_t k = 0; k < 3; k += hn::Lanes(d)) {
    const auto origin = hn::LoadU(d, padded + k);
    const auto used = hn::FirstN(d, 3 - k);
    auto fault = hn::Zero(bits);
    for (size_t i = 0; i < count; ++i) {
      const double* const at = positions[points[i].vertex].data() + k;
      // Nothing beyond the position is read, also by instructions that cannot mask.
      const auto p = k == 0 ? hn::MaskedLoad(used, d, at) : hn::IfThenElseZero(used, hn::Set(d, *at));
      const auto unit = hn::Mul(scale, hn::Sub(p, origin));
      hn::StoreU(unit, d, placed[i].data() + k);
      const auto expected = hn::BitCast(bits, hn::DemoteTo(single, unit));
      fault = hn::Or(fault, hn::Xor(expected, hn::BitCast(bits, hn::LoadU(single, words(points[i]) + k))));
      fault = hn::Or(fault, hn::Xor(expected, hn::BitCast(bits, hn::LoadU(single, words(regions[i]) + k))));
    }
    fault = hn::IfThenElseZero(hn::FirstN(bits, 3 - k), fault);
    if (!hn::AllTrue(bits, hn::Eq(fault, hn::Zero(bits)))) return false;
  }
  return true;
}

bool Contain(const tree::AabbTree::Node* nodes, const uint32_t* leaves, size_t count, const Triangle* corners,
             const PaddedPoint* placed) {
  const hn::CappedTag<double, 4> d;
  for (size_t leaf = 0; leaf < count; ++leaf) {
    const tree::AabbTree::Node& node = nodes[leaves[leaf]];
    const auto& [least, most] = node.box;
    const double box[] = {least[0], least[1], least[2], 0, most[0], most[1], most[2], 0};
    const Triangle* const begin = corners + node.first;
    for (size_t k = 0; k < 4; k += hn::Lanes(d)) {
      auto lo = hn::Set(d, kInfinity), hi = hn::Neg(lo);
      for (size_t i = 0; i < node.count; ++i)
        for (const std::uint32_t corner : begin[i]) {
          const auto p = hn::LoadU(d, placed[corner].data() + k);
          lo = hn::Min(lo, p);
          hi = hn::Max(hi, p);
        }
      if (!hn::AllTrue(d, hn::And(hn::Le(hn::LoadU(d, box + k), lo), hn::Le(hi, hn::LoadU(d, box + 4 + k)))))
        return false;
    }
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
HWY_EXPORT(AreBelow);
HWY_EXPORT(ArePlaced);
HWY_EXPORT(Contain);

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

bool have_limits(std::span<const tree::AabbTree::Node> nodes, std::span<const std::uint32_t> leaves,
                 std::span<const FaceBounds> bounds, float largest_radius) {
  return HWY_DYNAMIC_DISPATCH(HaveLimits)(nodes.data(), leaves.data(), leaves.size(), bounds.data(),
                                          largest_radius);
}

bool are_below(std::span<const std::uint32_t> indices, std::size_t count) {
  if (count == 0) return indices.empty();
  const auto most = static_cast<std::uint32_t>(count - 1);
  return HWY_DYNAMIC_DISPATCH(AreBelow)(indices.data(), indices.size(), {most, most, most, most, most, most});
}

bool are_below(std::span<const SitePlaces::Edge> edges, std::size_t points, std::size_t faces) {
  if (points == 0 || faces == 0) return edges.empty();
  const auto point = static_cast<std::uint32_t>(points - 1), face = static_cast<std::uint32_t>(faces - 1);
  static_assert(sizeof(SitePlaces::Edge) == 6 * sizeof(std::uint32_t));
  return HWY_DYNAMIC_DISPATCH(AreBelow)(reinterpret_cast<const std::uint32_t*>(edges.data()),
                                        6 * edges.size(), {point, point, point, point, face, face});
}

bool are_placed(const UnitFrame& frame, std::span<const Vec3> positions, std::span<const UnitVertex> points,
                std::span<const VertexRegion> regions, std::span<PaddedPoint> placed) {
  return HWY_DYNAMIC_DISPATCH(ArePlaced)(frame, positions.data(), points.data(), regions.data(),
                                         points.size(), placed.data());
}

bool contain(std::span<const tree::AabbTree::Node> nodes, std::span<const std::uint32_t> leaves,
             std::span<const Triangle> corners, std::span<const PaddedPoint> placed) {
  return HWY_DYNAMIC_DISPATCH(Contain)(nodes.data(), leaves.data(), leaves.size(), corners.data(),
                                       placed.data());
}

}  // namespace sdm::sites
#endif

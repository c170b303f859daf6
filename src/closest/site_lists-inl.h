// Candidate lists: collected from regions, and filtered from other lists. Included once for each set of
// vector instructions.
#if defined(SDM_SITE_LISTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_SITE_LISTS_INL_H
#undef SDM_SITE_LISTS_INL_H
#else
#define SDM_SITE_LISTS_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>

#include "closest/region_kernels-inl.h"
#include "closest/site_lists.h"

#ifndef SDM_SITE_LISTS_ONCE
#define SDM_SITE_LISTS_ONCE
namespace sdm::closest {
namespace {

// The positions of the set bits of each mask of eight bits, one byte each.
constexpr std::array<std::uint64_t, 256> kPositions = [] {
  std::array<std::uint64_t, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask)
    for (unsigned bit = 0, count = 0; bit < 8; ++bit)
      if (mask >> bit & 1) table[mask] |= std::uint64_t{bit} << (8 * count++);
  return table;
}();

}  // namespace
}  // namespace sdm::closest
#endif

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {

// Evaluates test(i) → mask over the lanes of a block and returns the first `count` results as a bit mask.
template <class Test>
HWY_INLINE uint32_t select(uint32_t count, const Test& test) {
  const Block d;
  uint32_t bits = 0;
  for (size_t i = 0; i < SiteBlock::kWidth; i += hn::Lanes(d)) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, test(i), bytes);
    bits |= static_cast<uint32_t>(bytes[0]) << i;
  }
  return bits & ((1u << count) - 1);
}

// Bytes as vector lanes: first the positions of the set bits in order, then others.
HWY_INLINE hn::Vec<hn::RebindToUnsigned<Block>> positions(uint64_t bytes_in_order) {
  const hn::Rebind<uint8_t, Block> bytes;
  return hn::PromoteTo(hn::RebindToUnsigned<Block>(),
                       hn::LoadU(bytes, reinterpret_cast<const uint8_t*>(&bytes_in_order)));
}

// Appends those of eight numbers whose bit is set.
HWY_INLINE void append(std::vector<uint32_t>& to, const uint32_t* numbers, uint32_t bits) {
  if constexpr (hn::MaxLanes(Block()) < SiteBlock::kWidth) {
    for (; bits != 0; bits &= bits - 1) to.push_back(numbers[std::countr_zero(bits)]);
  } else {
    const hn::RebindToUnsigned<Block> d;
    const size_t size = to.size();
    to.resize(size + SiteBlock::kWidth);
    const auto indices = hn::IndicesFromVec(d, positions(kPositions[bits]));
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(d, numbers), indices), d, to.data() + size);
    to.resize(size + static_cast<size_t>(std::popcount(bits)));
  }
}

// Fills four rows of a block, from `row` on, with the corresponding numbers of eight regions.
template <class TypedBlock>
HWY_INLINE void transpose_four(const typename TypedBlock::Region* const (&regions)[SiteBlock::kWidth],
                               size_t row, TypedBlock& block) {
  SiteBlock::Row* to = block.row + row;
  // A load may cross from one member of a region into the next: it reads the bytes of the whole region.
  const auto numbers = [&](size_t lane) {
    return reinterpret_cast<const std::byte*>(regions[lane]) + row * sizeof(float);
  };
#if HWY_TARGET == HWY_SCALAR
  for (size_t lane = 0; lane < SiteBlock::kWidth; ++lane) {
    float four[4];
    std::memcpy(four, numbers(lane), sizeof four);
    for (size_t k = 0; k < 4; ++k) to[k][lane] = four[k];
  }
#else
  const hn::Full128<float> d;
  const auto load = [&](size_t lane)
                        HWY_ATTR { return hn::LoadU(d, reinterpret_cast<const float*>(numbers(lane))); };
  for (size_t lane = 0; lane < SiteBlock::kWidth; lane += 4) {
    const auto a = load(lane), b = load(lane + 1), c = load(lane + 2), e = load(lane + 3);
    const auto ab_lower = hn::InterleaveLower(d, a, b), ce_lower = hn::InterleaveLower(d, c, e),
               ab_upper = hn::InterleaveUpper(d, a, b), ce_upper = hn::InterleaveUpper(d, c, e);
    hn::StoreU(hn::ConcatLowerLower(d, ce_lower, ab_lower), d, to[0] + lane);
    hn::StoreU(hn::ConcatUpperUpper(d, ce_lower, ab_lower), d, to[1] + lane);
    hn::StoreU(hn::ConcatLowerLower(d, ce_upper, ab_upper), d, to[2] + lane);
    hn::StoreU(hn::ConcatUpperUpper(d, ce_upper, ab_upper), d, to[3] + lane);
  }
#endif
}

// Builds a list of the regions at these places; id(place) is their SiteId.
template <class TypedBlock, class Id>
void gather(std::span<const uint32_t> places, std::span<const typename TypedBlock::Region> regions,
            const Id& id, SiteList<TypedBlock>& list) {
  constexpr size_t kWidth = SiteBlock::kWidth, kAhead = 4 * kWidth;
  list.used = (places.size() + kWidth - 1) / kWidth;
  if (list.used > list.blocks.size()) list.blocks.resize(2 * list.used);
  for (size_t i = 0; i < std::min(kAhead, places.size()); ++i) hwy::Prefetch(&regions[places[i]]);
  for (size_t b = 0; b < list.used; ++b) {
    TypedBlock& block = list.blocks[b];
    const typename TypedBlock::Region* from[kWidth];
    block.count = static_cast<uint32_t>(std::min(kWidth, places.size() - kWidth * b));
    for (size_t lane = 0; lane < kWidth; ++lane) {
      const size_t i = kWidth * b + lane;
      if (i + kAhead < places.size()) hwy::Prefetch(&regions[places[i + kAhead]]);
      from[lane] = &regions[places[std::min(i, places.size() - 1)]];
    }
    // The last group of four overlaps the one before, if there are fifteen rows.
    static_assert(TypedBlock::kRows == 15 || TypedBlock::kRows == 16);
    for (size_t row = 0; row < TypedBlock::kRows; row += 4)
      transpose_four(from, std::min(row, TypedBlock::kRows - 4), block);
    for (size_t lane = 0; lane < block.count; ++lane) block.id[lane] = id(places[kWidth * b + lane]).packed;
  }
}

// Appends the sites of a block whose bit is set: first to the list's last block, then to a new one.
template <class TypedBlock>
void append(SiteList<TypedBlock>& list, const TypedBlock& block, uint32_t bits) {
  constexpr uint32_t kWidth = SiteBlock::kWidth;
  if (list.used + 1 >= list.blocks.size()) list.blocks.resize(2 * list.blocks.size() + 2);
  if (list.used == 0 || list.blocks[list.used - 1].count == kWidth) list.blocks[list.used++].count = 0;
  TypedBlock &last = list.blocks[list.used - 1], &next = list.blocks[list.used];
  const uint32_t filled = last.count, total = filled + static_cast<uint32_t>(std::popcount(bits));
  last.count = std::min(total, kWidth);
  if (total > kWidth) {
    next.count = total - kWidth;
    ++list.used;
  }
  if constexpr (hn::MaxLanes(Block()) < kWidth) {
    for (uint32_t at = filled; bits != 0; bits &= bits - 1, ++at) {
      const int lane = std::countr_zero(bits);
      TypedBlock& to = at < kWidth ? last : next;
      for (size_t row = 0; row < TypedBlock::kRows; ++row) to.row[row][at % kWidth] = block.row[row][lane];
      to.id[at % kWidth] = block.id[lane];
    }
  } else {
    // One permutation moves the sites to the lanes from `filled` on. Those that do not fit wrap around to the
    // front, where they belong in the next block.
    const Block d;
    const hn::RebindToUnsigned<Block> du;
    const auto indices = positions(std::rotl(kPositions[bits], static_cast<int>(8 * filled)));
    const auto move = [&](auto tag, const auto* row, auto* out, auto* out_next) HWY_ATTR {
      const auto moved = hn::TableLookupLanes(hn::LoadU(tag, row), hn::IndicesFromVec(tag, indices));
      hn::StoreU(hn::IfThenElse(hn::FirstN(tag, filled), hn::LoadU(tag, out), moved), tag, out);
      if (total > kWidth) hn::StoreU(moved, tag, out_next);
    };
    for (size_t row = 0; row < TypedBlock::kRows; ++row)
      move(d, block.row[row], last.row[row], next.row[row]);
    move(du, block.id, last.id, next.id);
  }
}

// Appends the candidates of a block.
template <class TypedBlock>
HWY_INLINE void keep(const TypedBlock& block, const CandidateBound& bound, SiteList<TypedBlock>& list) {
  const uint32_t bits =
      select(block.count, [&](size_t i) HWY_ATTR { return may_be_closest(Block(), block, i, bound); });
  if (bits != 0) append(list, block, bits);
}

template <class TypedBlock>
void keep(const SiteList<TypedBlock>& from, const CandidateBound& bound, SiteList<TypedBlock>& to) {
  to.used = 0;
  for (size_t i = 0; i < from.used; ++i) keep(from.blocks[i], bound, to);
}

}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// Orders of points in which consecutive points are near each other in space.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::core {

/// Indices of the points along a Morton curve through a grid of 1024³ cells that fills the part of `box` with
/// points; points outside belong to the nearest cell, points of one cell are in the order of their indices.
/// Neighbours in this order are mostly near each other, at a fraction of the time of spatial_order(), which
/// also bounds how far. Cost: O(n), all cores.
[[nodiscard]] std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Box& box);

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

namespace sdm::core {

/// Indices of the points such that every aligned run of 16·2^k points lies in a small box: the points are
/// split in half along the longest side of their box, recursively, down to packets of sixteen. Cost: O(n log
/// n), all cores.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points);

/// The extent of points along one axis.
struct Side {
  std::size_t axis;
  float lower, upper;
};

/// The longest side of the box around the items' points, `point` of each. There must be an item.
template <class Item>
Side longest_side(std::span<const Item> items) {
  Vec3f lo = items[0].point, hi = lo;
  for (const Item& item : items)
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], item.point[k]);
      hi[k] = std::max(hi[k], item.point[k]);
    }
  const Vec3f size{hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]};
  const auto axis = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
  return {axis, lo[axis], hi[axis]};
}

/// The items among which a split lies.
struct SplitRange {
  std::size_t begin, end;
  std::size_t before;  ///< weight of the items before `begin`
};

/// Reorders the items so that those before `begin` have smaller coordinates along the side than those of the
/// range, and those after it larger ones, where the first `weight` of the items in the order of their
/// coordinates ends in the range. Takes a fraction of the time of a selection, which then remains for the
/// items of the range: in two passes, no item moves more than twice, and no branch depends on a coordinate.
template <class Item, class Weight>
SplitRange split_range(std::span<Item> items, const Side& side, std::size_t weight, const Weight& weight_of) {
  constexpr std::size_t kBins = 64, kWorthwhile = 96;
  if (items.size() < kWorthwhile) return {0, items.size(), 0};
  const float per_bin = kBins / (side.upper - side.lower);
  const auto bin_of = [&](const Item& item) {
    const float bin = (item.point[side.axis] - side.lower) * per_bin;
    return bin < kBins - 1 ? static_cast<std::size_t>(bin) : kBins - 1;  // the last one for NaN, too
  };
  std::array<std::size_t, kBins> weights{};
  for (const Item& item : items) weights[bin_of(item)] += weight_of(item);
  std::size_t bin = 0, before = 0;
  while (bin < kBins - 1 && before + weights[bin] <= weight) before += weights[bin++];
  // Moves the items of the first `bins` bins to the front, from `begin` on.
  const auto to_front = [&](std::size_t begin, std::size_t bins) {
    std::size_t end = begin;
    for (std::size_t i = begin; i < items.size(); ++i) {
      const Item item = items[i];
      items[i] = items[end];
      items[end] = item;
      end += bin_of(item) < bins;
    }
    return end;
  };
  const std::size_t begin = to_front(0, bin);
  return {begin, to_front(begin, bin + 1), before};
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

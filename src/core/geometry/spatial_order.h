// An order of points in which consecutive points are near each other in space.
#pragma once

#include <sdm/types.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace sdm::core {

/// Indices of the points such that every aligned run of 16·2^k points lies in a small box: the points are
/// split in half along the longest side of their box, recursively, down to packets of sixteen. Cost: O(n log
/// n), all cores.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points);

/// The axis along which the items' points, `point` of each, extend farthest. There must be an item.
template <class Item>
std::size_t longest_side(std::span<const Item> items) {
  Vec3f lo = items[0].point, hi = lo;
  for (const Item& item : items)
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], item.point[k]);
      hi[k] = std::max(hi[k], item.point[k]);
    }
  const Vec3f size{hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]};
  return static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}

#include "geometry/spatial_order.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::core {
namespace {

constexpr std::size_t kPacket = 16;
constexpr std::size_t kParallelItems = 1 << 15;  // below this, one thread

struct Item {
  Vec3f point;
  std::uint32_t index;
};

// All halves but the last hold 16·2^k items, so that all packets but the last are full.
void order(std::span<Item> items) {
  if (items.size() <= kPacket) {
    std::ranges::sort(items, {}, &Item::index);  // a selection leaves them in any order
    return;
  }
  const std::size_t half = kPacket * std::bit_floor((items.size() - 1) / kPacket);
  const Side side = longest_side<Item>(items);
  const SplitRange range = split_range(items, side, half, [](const Item&) { return 1; });
  std::ranges::nth_element(items.subspan(range.begin, range.end - range.begin),
                           items.begin() + static_cast<std::ptrdiff_t>(half), {}, [&side](const Item& item) {
                             return std::pair(item.point[side.axis],
                                              item.index);  // unique, so the half is too
                           });
  const auto first = [=] { order(items.first(half)); };
  const auto second = [=] { order(items.subspan(half)); };
  if (items.size() >= kParallelItems) {
    parallel_invoke(first, second);
  } else {
    first();
    second();
  }
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) extend(box, p);
  const Vec3 size = points.empty() ? Vec3{} : box.hi - box.lo;
  const double longest = std::max({size[0], size[1], size[2]});
  const double scale = longest > 0 ? 1 / longest : 0;
  std::vector<Item> items(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 q = scale * (points[i] - box.lo);
    items[i] = {{static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])},
                static_cast<std::uint32_t>(i)};
  }
  order(items);
  std::vector<std::uint32_t> indices(points.size());
  std::ranges::transform(items, indices.begin(), &Item::index);
  return indices;
}

}  // namespace sdm::core

#include "geometry/spatial_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::core {
namespace {

constexpr std::uint32_t kAxisBits = 10, kDigitBits = 10, kDigits = 1 << kDigitBits;
constexpr std::uint32_t kPasses = 3 * kAxisBits / kDigitBits;
constexpr std::size_t kPart = 1 << 16;  // points whose digits are counted together
// Fewer points than this are compared: a radix sort counts all digits that there are.
constexpr std::size_t kFewest = 512;

struct Coded {
  std::uint32_t code, index;
};

// Moves bit i to bit 3 i.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000FFu;
  x = (x | x << 8) & 0x0300F00Fu;
  x = (x | x << 4) & 0x030C30C3u;
  x = (x | x << 2) & 0x09249249u;
  return x;
}

// One pass of a radix sort, by the digit from this bit on. Each part writes to places of its own, after those
// of the parts before it, so equal items keep their order.
void sort_by_digit(std::span<const Coded> items, std::uint32_t bit, std::span<Coded> sorted) {
  const std::size_t parts = (items.size() + kPart - 1) / kPart;
  std::vector<std::array<std::uint32_t, kDigits>> places(parts);
  const auto digit = [bit](const Coded& item) { return item.code >> bit & (kDigits - 1); };
  const auto part = [&](std::size_t i) {
    return items.subspan(kPart * i, std::min(kPart, items.size() - kPart * i));
  };
  parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const Coded& item : part(i)) ++places[i][digit(item)];
  });
  std::uint32_t total = 0;
  for (std::uint32_t d = 0; d < kDigits; ++d)
    for (auto& place : places) total += std::exchange(place[d], total);
  parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const Coded& item : part(i)) sorted[places[i][digit(item)]++] = item;
  });
}

}  // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Box& box) {
  Box cells;
  for (const Vec3& p : points) extend(cells, p);
  Vec3 cells_per_unit{};
  for (int k = 0; k < 3; ++k) {
    cells.lower[k] = std::clamp(cells.lower[k], box.lower[k], box.upper[k]);
    const double size = std::clamp(cells.upper[k], box.lower[k], box.upper[k]) - cells.lower[k];
    if (size > 0) cells_per_unit[k] = (1 << kAxisBits) / size;
  }
  std::vector<Coded> items(points.size());
  parallel_for(points.size(), kPart, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t code = 0;
      for (int k = 0; k < 3; ++k) {
        const double cell = (points[i][k] - cells.lower[k]) * cells_per_unit[k];
        constexpr double kLast = (1 << kAxisBits) - 1;
        code |= spread(static_cast<std::uint32_t>(cell > 0 ? std::min(cell, kLast) : 0.0)) << k;
      }
      items[i] = {code, static_cast<std::uint32_t>(i)};
    }
  });
  if (items.size() < kFewest) {
    std::ranges::sort(items, {}, [](const Coded& item) { return std::pair(item.code, item.index); });
  } else {
    std::vector<Coded> sorted(items.size());
    for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
      sort_by_digit(items, kDigitBits * pass, sorted);
      items.swap(sorted);
    }
  }
  std::vector<std::uint32_t> order(points.size());
  std::ranges::transform(items, order.begin(), &Coded::index);
  return order;
}

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
  const Vec3 size = points.empty() ? Vec3{} : box.upper - box.lower;
  const double longest = std::max({size[0], size[1], size[2]});
  const double scale = longest > 0 ? 1 / longest : 0;
  std::vector<Item> items(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 q = scale * (points[i] - box.lower);
    items[i] = {{static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])},
                static_cast<std::uint32_t>(i)};
  }
  order(items);
  std::vector<std::uint32_t> indices(points.size());
  std::ranges::transform(items, indices.begin(), &Item::index);
  return indices;
}

}  // namespace sdm::core

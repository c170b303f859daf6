#include "geometry/morton_order.h"

#include <algorithm>
#include <array>
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
    cells.lo[k] = std::clamp(cells.lo[k], box.lo[k], box.hi[k]);
    const double size = std::clamp(cells.hi[k], box.lo[k], box.hi[k]) - cells.lo[k];
    if (size > 0) cells_per_unit[k] = (1 << kAxisBits) / size;
  }
  std::vector<Coded> items(points.size());
  parallel_for(points.size(), kPart, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint32_t code = 0;
      for (int k = 0; k < 3; ++k) {
        const double cell = (points[i][k] - cells.lo[k]) * cells_per_unit[k];
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

}  // namespace sdm::core

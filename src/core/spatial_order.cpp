#include "core/spatial_order.h"

#include <algorithm>
#include <utility>

#include "core/vec.h"

namespace sdm {
namespace {

// Moves bit i of a 21-bit number to bit 3i.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFull;
  x = (x | x << 16) & 0x001F0000FF0000FFull;
  x = (x | x << 8) & 0x100F00F00F00F00Full;
  x = (x | x << 4) & 0x10C30C30C30C30C3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) extend(box, p);
  const Vec3 size = points.empty() ? Vec3{} : box.hi - box.lo;
  const double longest = std::max({size[0], size[1], size[2]});
  const double scale = longest > 0 ? ((1 << 21) - 1) / longest : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 q = scale * (points[i] - box.lo);
    keys[i] = {spread(static_cast<std::uint64_t>(q[0])) | spread(static_cast<std::uint64_t>(q[1])) << 1 |
                   spread(static_cast<std::uint64_t>(q[2])) << 2,
               static_cast<std::uint32_t>(i)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(points.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const auto& key) { return key.second; });
  return order;
}

}  // namespace sdm

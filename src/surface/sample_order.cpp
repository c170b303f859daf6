#include "surface/sample_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <span>
#include <utility>

#include "core/geometry/spatial_order.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

constexpr std::uint32_t kSide = 4;          // of a square of texels
constexpr std::size_t kPacket = 16;         // samples
constexpr std::size_t kSingle = 64;         // this many samples are ordered one by one
constexpr std::size_t kParallel = 1 << 15;  // below this many samples, one thread

/// The texels [first, first + count) of a list: those of one chart in one square, so they are close together
/// on the surface.
struct Group {
  Vec3 point;  ///< of one of them
  std::uint32_t first, count;
};

/// A k-d tree over samples, as that of spatial_order(), which sorts groups of them instead as far as
/// possible: a split that falls into a group divides it.
class SampleOrder {
 public:
  explicit SampleOrder(const SurfaceData& surface) : surface_(surface) {
    const std::uint32_t n = surface.resolution, rows = (n + kSide - 1) / kSide;
    std::vector<std::vector<Group>> of_row(rows);
    std::vector<std::vector<std::uint32_t>> texels_of_row(rows);
    parallel_for(rows, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        add_row(static_cast<std::uint32_t>(row), of_row[row], texels_of_row[row]);
    });
    for (std::uint32_t row = 0; row < rows; ++row) {
      for (Group& group : of_row[row]) {
        group.first += static_cast<std::uint32_t>(texels_.size());
        groups_.push_back(group);
      }
      texels_.insert(texels_.end(), texels_of_row[row].begin(), texels_of_row[row].end());
      of_row[row] = {}, texels_of_row[row] = {};
    }
  }

  std::vector<std::uint32_t> operator()() {
    std::vector<std::uint32_t> result(texels_.size());
    order(std::move(groups_), result);
    return result;
  }

 private:
  [[nodiscard]] Vec3 point(std::uint32_t texel) const {
    return surface_.texel_point(surface_.texel_faces[texel], texel);
  }
  [[nodiscard]] std::span<std::uint32_t> texels_of(const Group& group) {
    return std::span(texels_).subspan(group.first, group.count);
  }
  [[nodiscard]] Group group(std::size_t first, std::size_t count) {
    return {point(texels_[first + count / 2]), static_cast<std::uint32_t>(first),
            static_cast<std::uint32_t>(count)};
  }

  // Adds the groups of a row of squares; their texels start at 0.
  void add_row(std::uint32_t row, std::vector<Group>& groups, std::vector<std::uint32_t>& texels) const {
    const std::uint32_t n = surface_.resolution;
    const auto chart_of = [&](std::uint32_t texel) {
      return surface_.face_charts[surface_.texel_faces[texel]];
    };
    for (std::uint32_t left = 0; left < n; left += kSide) {
      const std::size_t begin = texels.size();
      for (std::uint32_t y = row * kSide; y < std::min(n, (row + 1) * kSide); ++y)
        for (std::uint32_t x = left; x < std::min(n, left + kSide); ++x)
          if (const std::uint32_t texel = y * n + x; surface_.texel_faces[texel] != kNone)
            texels.push_back(texel);
      std::stable_sort(texels.begin() + static_cast<std::ptrdiff_t>(begin), texels.end(),
                       [&](auto a, auto b) { return chart_of(a) < chart_of(b); });
      for (std::size_t first = begin, i = begin; i < texels.size(); ++i)
        if (i + 1 == texels.size() || chart_of(texels[i]) != chart_of(texels[i + 1])) {
          groups.push_back({point(texels[(first + i) / 2]), static_cast<std::uint32_t>(first),
                            static_cast<std::uint32_t>(i + 1 - first)});
          first = i + 1;
        }
    }
  }

  void order(std::vector<Group> groups, std::span<std::uint32_t> result) {
    if (result.size() <= kSingle) return order_singly(groups, result);
    // As in spatial_order(): all packets but the last are full.
    const std::size_t half = kPacket * std::bit_floor((result.size() - 1) / kPacket);
    std::vector<Group> others = split(groups, half);
    const auto first = [&] { order(std::move(groups), result.first(half)); };
    const auto second = [&] { order(std::move(others), result.subspan(half)); };
    if (result.size() >= kParallel) {
      parallel_invoke(first, second);
    } else {
      first();
      second();
    }
  }

  void order_singly(std::span<const Group> groups, std::span<std::uint32_t> result) {
    std::array<std::uint32_t, kSingle> texels;
    std::array<Vec3, kSingle> points;
    std::size_t count = 0;
    for (const Group& group : groups)
      for (const std::uint32_t texel : texels_of(group)) {
        points[count] = point(texel);
        texels[count++] = texel;
      }
    std::ranges::transform(spatial_order(std::span(points).first(count)), result.begin(),
                           [&](std::uint32_t i) { return texels[i]; });
  }

  // Removes all but the first `count` samples along the longest side, and returns them.
  std::vector<Group> split(std::vector<Group>& groups, std::size_t count) {
    Box box;
    for (const Group& g : groups) extend(box, g.point);
    const Vec3 size = box.hi - box.lo;
    const std::ptrdiff_t axis = std::ranges::max_element(size) - size.begin();
    const auto along = [axis](const Group& g) { return std::pair(g.point[axis], g.first); };  // unique
    // The group at which the samples before it reach `count` lies in [begin, end).
    auto begin = groups.begin(), end = groups.end();
    std::size_t before = 0;  // samples of the groups before `begin`
    while (end - begin > 1) {
      const auto middle = begin + (end - begin) / 2;
      std::ranges::nth_element(begin, middle, end, {}, along);
      const std::size_t samples = std::accumulate(
          begin, middle, before, [](std::size_t sum, const Group& g) { return sum + g.count; });
      if (samples <= count) {
        before = samples, begin = middle;
      } else {
        end = middle;
      }
    }
    std::vector<Group> others;
    if (before < count) {  // the split falls into the group at `begin`
      const Group whole = *begin;
      const auto texels = texels_of(whole);
      const std::size_t kept = count - before;
      std::ranges::nth_element(texels, texels.begin() + static_cast<std::ptrdiff_t>(kept), {},
                               [&](std::uint32_t texel) { return std::pair(point(texel)[axis], texel); });
      *begin++ = group(whole.first, kept);
      others.push_back(group(whole.first + kept, whole.count - kept));
    }
    others.insert(others.end(), begin, groups.end());
    groups.erase(begin, groups.end());
    return others;
  }

  const SurfaceData& surface_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> texels_;
};

}  // namespace

std::vector<std::uint32_t> sample_order(const SurfaceData& surface) {
  return SampleOrder(surface)();
}

}  // namespace sdm::surface

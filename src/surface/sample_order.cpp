#include "surface/sample_order.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <numeric>
#include <span>
#include <utility>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/spatial_order.h"
#include "geometry/unit_frame.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

constexpr std::uint32_t kSide = 4;  // of a square of texels
static_assert(kPacket == kSide * kSide);
constexpr std::size_t kParallel = 1 << 13;  // below this many items, one thread

// Up to this resolution every texel is on its own: packets are then smaller and maps faster, which is what
// counts where one atlas serves many frames. Above it, ordering single texels would take longer than maps
// gain.
constexpr std::uint32_t kSingleTexels = 512;

/// A square of texels, or a single sample that is in no such square.
struct Item {
  Vec3f point;          ///< of the square's middle, in the unit frame
  std::uint32_t texel;  ///< the upper left one
  bool single;

  [[nodiscard]] std::size_t samples() const { return single ? 1 : kPacket; }
};

class SampleOrder {
 public:
  explicit SampleOrder(const SurfaceData& surface)
      : surface_(surface), frame_(UnitFrame::of(bounds(surface.mesh))) {}

  std::vector<std::uint32_t> operator()() const {
    std::vector<Item> items = all_items();
    std::vector<std::uint32_t> result(count(items));
    order(items, result);
    return result;
  }

 private:
  [[nodiscard]] static std::size_t count(std::span<const Item> items) {
    return std::accumulate(items.begin(), items.end(), std::size_t{0},
                           [](std::size_t sum, const Item& item) { return sum + item.samples(); });
  }

  [[nodiscard]] std::vector<Item> all_items() const {
    const std::uint32_t n = surface_.resolution, rows = (surface_.rows + kSide - 1) / kSide;
    std::vector<std::vector<Item>> of_row(rows);
    parallel_for(rows, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        for (std::uint32_t left = 0; left < n; left += kSide)
          add_square(left, static_cast<std::uint32_t>(row) * kSide, of_row[row]);
    });
    std::vector<Item> items;
    for (std::vector<Item>& row : of_row) {
      items.insert(items.end(), row.begin(), row.end());
      row = {};
    }
    for (std::uint32_t i = surface_.texels(); i < surface_.map_faces.size(); ++i)
      items.push_back({point(i), i, true});
    return items;
  }

  // Adds the square with this upper left corner if one chart owns all of it, otherwise its texels.
  void add_square(std::uint32_t left, std::uint32_t top, std::vector<Item>& items) const {
    const std::uint32_t n = surface_.resolution;
    const std::uint32_t right = std::min(n, left + kSide), bottom = std::min(surface_.rows, top + kSide);
    const auto chart_of = [&](std::uint32_t x, std::uint32_t y) {
      const std::uint32_t face = surface_.map_faces[std::size_t{y} * n + x];
      return face == kNone ? kNone : surface_.face_charts[face];
    };
    const std::uint32_t chart = chart_of(left, top);
    bool whole = std::max(n, surface_.rows) > kSingleTexels && chart != kNone && right - left == kSide &&
                 bottom - top == kSide;
    for (std::uint32_t y = top; y < bottom && whole; ++y)
      for (std::uint32_t x = left; x < right && whole; ++x) whole = chart_of(x, y) == chart;
    if (whole) {
      items.push_back({point((top + kSide / 2) * n + left + kSide / 2), top * n + left, false});
      return;
    }
    for (std::uint32_t y = top; y < bottom; ++y)
      for (std::uint32_t x = left; x < right; ++x)
        if (chart_of(x, y) != kNone) items.push_back({point(y * n + x), y * n + x, true});
  }

  [[nodiscard]] Vec3f point(std::uint32_t sample) const {
    const Vec3 p = frame_.to_unit(surface_.texel_point(surface_.map_faces[sample], sample));
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
  }

  // A k-d tree whose nodes hold 16·2^k samples, but for the last one of a level. Single samples come in
  // multiples of 16 as well, so that no square is divided.
  void order(std::span<Item> items, std::span<std::uint32_t> result) const {
    if (result.size() <= kPacket) return write(items, result);
    const std::size_t half = kPacket * std::bit_floor((result.size() - 1) / kPacket);
    const std::size_t middle = split(items, half);
    const auto first = [&] { order(items.first(middle), result.first(half)); };
    const auto second = [&] { order(items.subspan(middle), result.subspan(half)); };
    if (items.size() >= kParallel) {
      parallel_invoke(first, second);
    } else {
      first();
      second();
    }
  }

  // One square, or single samples, which selections leave in any order.
  void write(std::span<Item> items, std::span<std::uint32_t> result) const {
    std::ranges::sort(items, {}, &Item::texel);
    std::size_t next = 0;
    for (const Item& item : items)
      for (std::uint32_t k = 0; k < item.samples(); ++k)
        result[next++] = item.texel + k / kSide * surface_.resolution + k % kSide;
  }

  // Moves items with `samples` samples in all, a multiple of 16, to the front: those with the smallest
  // coordinates along the longest side, but for a few single ones near the split. Returns their number.
  [[nodiscard]] static std::size_t split(std::span<Item> items, std::size_t samples) {
    const Side side = longest_side<Item>(items);
    const auto along = [&side](const Item& item) {
      return std::pair(item.point[side.axis], item.texel);
    };  // unique
    const auto sort_out = [&](std::span<Item> part, std::size_t nth) {
      std::ranges::nth_element(part, part.begin() + static_cast<std::ptrdiff_t>(nth), {}, along);
    };
    // The item at which the samples before it exceed the number lies in [begin, end).
    auto [begin, end, before] =
        split_range(items, side, samples, [](const Item& item) { return item.samples(); });
    while (end - begin > 1) {
      const std::size_t middle = begin + (end - begin) / 2;
      sort_out(items.subspan(begin, end - begin), middle - begin);
      if (const std::size_t more = count(items.subspan(begin, middle - begin)); before + more <= samples) {
        before += more;
        begin = middle;
      } else {
        end = middle;
      }
    }
    const std::size_t missing = samples - before;
    if (missing == 0) return begin;
    // The item there is a square. It stays behind if enough single samples can take its place, otherwise it
    // takes the place of single samples: of those before it, there are 16 − missing modulo 16.
    const std::span<Item> rest = items.subspan(begin);
    const auto is_single = [](const Item& item) { return item.single; };
    const auto singles_end = std::partition(rest.begin() + 1, rest.end(), is_single);
    const std::span<Item> singles(rest.begin() + 1, singles_end);
    if (missing <= kPacket / 2 && singles.size() >= missing) {
      sort_out(singles, missing - 1);
      std::swap(rest[0], rest[missing]);
      return begin + missing;
    }
    const std::span<Item> front = items.first(begin);
    const auto squares_end = std::partition(front.begin(), front.end(), std::not_fn(is_single));
    const std::span<Item> last(squares_end, front.end());
    const std::size_t kept = last.size() - (kPacket - missing);
    if (kept < last.size()) sort_out(last, kept);
    std::swap(last[kept], rest[0]);
    return begin - (kPacket - missing) + 1;
  }

  const SurfaceData& surface_;
  const UnitFrame frame_;  ///< in which single precision suffices for points
};

}  // namespace

std::vector<std::uint32_t> sample_order(const SurfaceData& surface) {
  return SampleOrder(surface)();
}

void edit_samples(SurfaceData& s, std::span<const std::uint8_t> removed_faces,
                  std::span<const std::uint32_t> added, std::uint32_t texels_before) {
  const std::size_t before = s.samples.size(), packets = (before + kPacket - 1) / kPacket;
  const auto end_of = [&](std::size_t packet) { return std::min(before, (packet + 1) * kPacket); };
  const auto is_removed = [&](std::size_t i) { return removed_faces[s.sample_faces[i]] != 0; };

  // Where a sample that stays is now.
  const auto without = std::span<const std::uint32_t>(s.map_faces).subspan(s.texels());
  const auto index_of = [&](std::size_t i) {
    if (s.samples[i] < texels_before) return s.samples[i];
    const auto place = std::ranges::lower_bound(without, s.sample_faces[i]) - without.begin();
    return s.texels() + static_cast<std::uint32_t>(place);
  };

  std::vector<std::uint32_t> open;  // packets that lose a sample
  std::size_t removed = 0;
  for (std::size_t p = 0; p < packets; ++p) {
    std::size_t of_packet = 0;
    for (std::size_t i = p * kPacket; i < end_of(p); ++i) of_packet += is_removed(i);
    if (of_packet > 0) open.push_back(static_cast<std::uint32_t>(p));
    removed += of_packet;
  }
  if (removed == 0 && added.empty()) return;
  // What is not full at the end, or beyond the new end, is distributed as well.
  const std::size_t after = before - removed + added.size();
  const std::size_t full = std::min(before, after) / kPacket;
  while (!open.empty() && open.back() >= full) open.pop_back();
  for (std::size_t p = full; p < packets; ++p) open.push_back(static_cast<std::uint32_t>(p));

  std::vector<std::uint32_t> texels;
  for (const std::uint32_t p : open)
    for (std::size_t i = p * kPacket; i < end_of(p); ++i)
      if (!is_removed(i)) texels.push_back(index_of(i));
  texels.insert(texels.end(), added.begin(), added.end());
  std::vector<Vec3> points(texels.size());
  for (std::size_t i = 0; i < texels.size(); ++i)
    points[i] = s.texel_point(s.map_faces[texels[i]], texels[i]);
  const std::vector<std::uint32_t> order = spatial_order(points);

  reserve_for(s.samples, after);
  reserve_for(s.sample_faces, after);
  for (std::size_t i = 0; i < before; ++i)  // from here on, nothing fails
    if (!is_removed(i)) s.samples[i] = index_of(i);
  s.samples.resize(after);
  s.sample_faces.resize(after);
  std::size_t next = 0;
  const auto fill = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      s.samples[i] = texels[order[next++]];
      s.sample_faces[i] = s.map_faces[s.samples[i]];
    }
  };
  for (const std::uint32_t p : open)
    if (p < full) fill(p * kPacket, (p + 1) * kPacket);
  fill(full * kPacket, after);
}

}  // namespace sdm::surface

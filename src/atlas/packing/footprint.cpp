#include "atlas/packing/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "atlas/packing/rasterise.h"
#include "core/geometry/vec.h"
#include "core/scattered_order.h"

namespace sdm::atlas {
namespace {

/// One byte per cell.
struct Bitmap {
  Bitmap(std::uint32_t columns, std::uint32_t rows)
      : width(columns), height(rows), cells(std::size_t{columns} * rows, 0) {}
  [[nodiscard]] std::uint8_t* row(std::size_t y) { return &cells[y * width]; }
  [[nodiscard]] const std::uint8_t* row(std::size_t y) const { return &cells[y * width]; }

  std::uint32_t width, height;
  std::vector<std::uint8_t> cells;
};

std::array<Vec2, 3> placed(const std::array<Vec2, 3>& t, double scale, const Vec2& shift) {
  return {scale * t[0] + shift, scale * t[1] + shift, scale * t[2] + shift};
}

bool owns_texel(const Shape& shape, double scale, const Vec2& shift) {
  const auto covers = [&](const std::array<Vec2, 3>& t) {
    bool any = false;
    for_each_centre(placed(t, scale, shift), [&](auto, auto) { any = true; });
    return any;
  };
  return covers(shape.triangles[shape.largest]) ||
         std::any_of(shape.triangles.begin(), shape.triangles.end(), covers);
}

// Moves the centroid of the largest face by less than a texel onto a texel centre.
Vec2 centring_shift(const Shape& shape, double scale) {
  const auto& t = shape.triangles[shape.largest];
  Vec2 shift;
  for (int k = 0; k < 2; ++k) {
    const double centroid = scale * (t[0][k] + t[1][k] + t[2][k]) / 3;
    shift[k] = std::ceil(centroid + 0.5) - (centroid + 0.5);
  }
  return shift;
}

// Fills the texels that the closed triangle touches, and `reach` more to the left and right.
void fill_touched(Bitmap& bitmap, const std::array<Vec2, 3>& t, std::uint32_t reach) {
  const auto [lo, hi] = std::minmax({t[0][1], t[1][1], t[2][1]});
  const double rows = bitmap.height - 1.0, columns = bitmap.width - 1.0;
  const auto first = static_cast<std::size_t>(std::clamp(std::floor(lo), 0.0, rows));
  const auto last = static_cast<std::size_t>(std::clamp(std::floor(hi), 0.0, rows));
  for (std::size_t y = first; y <= last; ++y) {
    // The part of the triangle between two horizontal lines is convex: its leftmost and rightmost points are
    // ends of clipped edges.
    const double top = y == first ? lo : static_cast<double>(y);
    const double bottom = y == last ? hi : static_cast<double>(y) + 1;
    double left = std::numeric_limits<double>::infinity(), right = -left;
    for (int k = 0; k < 3; ++k) {
      const Vec2 &a = t[k], &b = t[(k + 1) % 3];
      if (std::max(a[1], b[1]) < top || std::min(a[1], b[1]) > bottom) continue;
      const auto x_at = [&](const Vec2& end) {
        const double line = std::clamp(end[1], top, bottom);
        return line == end[1] ? end[0] : a[0] + (line - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
      };
      left = std::min({left, x_at(a), x_at(b)});
      right = std::max({right, x_at(a), x_at(b)});
    }
    if (left > right) continue;
    const auto begin = static_cast<std::size_t>(std::clamp(std::floor(left) - reach, 0.0, columns));
    const auto end = static_cast<std::size_t>(std::clamp(std::floor(right) + reach, 0.0, columns));
    std::fill(bitmap.row(y) + begin, bitmap.row(y) + end + 1, 1);
  }
}

Bitmap spread_rows(const Bitmap& bitmap, std::uint32_t reach) {
  Bitmap result(bitmap.width, bitmap.height);
  for (std::uint32_t y = 0; y < bitmap.height; ++y)
    for (std::uint32_t from = y > reach ? y - reach : 0; from <= std::min(y + reach, bitmap.height - 1);
         ++from)
      std::transform(bitmap.row(from), bitmap.row(from) + bitmap.width, result.row(y), result.row(y),
                     [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a | b); });
  return result;
}

// (x, y) → (height − 1 − y, x), as in turned().
Bitmap turn(const Bitmap& bitmap) {
  Bitmap result(bitmap.height, bitmap.width);
  for (std::uint32_t y = 0; y < bitmap.height; ++y)
    for (std::uint32_t x = 0; x < bitmap.width; ++x) result.row(x)[bitmap.height - 1 - y] = bitmap.row(y)[x];
  return result;
}

Stamp make_stamp(const Bitmap& bitmap) {
  std::vector<Run> runs;
  for (std::uint32_t y = 0; y < bitmap.height; ++y) {
    const std::uint8_t* row = bitmap.row(y);
    for (std::uint32_t x = 0; x < bitmap.width;) {
      const std::uint32_t begin = x;
      while (x < bitmap.width && row[x]) ++x;
      if (x > begin) runs.push_back({y, begin, x - begin});
      while (x < bitmap.width && !row[x]) ++x;
    }
  }
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
    return std::pair(b.length, a.row) < std::pair(a.length, b.row);
  });
  Stamp stamp{bitmap.width, bitmap.height, {}};
  for (const std::uint32_t i : scattered_order(runs.size())) stamp.runs.push_back(runs[i]);
  return stamp;
}

Stamp half_turned(Stamp stamp) {
  for (Run& run : stamp.runs) {
    run.row = stamp.height - 1 - run.row;
    run.begin = stamp.width - run.begin - run.length;
  }
  return stamp;
}

}  // namespace

Footprint make_footprint(const Shape& shape, const FootprintOptions& options) {
  const double scale = options.scale;
  const std::uint32_t gutter = options.gutter, cell = options.cell;
  const std::uint32_t reach = (gutter + cell - 1) / cell;  // of the gutter, in cells
  Footprint result;
  if (!owns_texel(shape, scale, {0, 0})) result.shift = centring_shift(shape, scale);
  const auto cells = [&](int k) {
    // A point on the line between two cells touches both.
    const double extent = (scale * shape.size[k] + result.shift[k]) / cell;
    return static_cast<std::uint32_t>(extent) + 1 + 2 * reach;
  };
  Bitmap bitmap(cells(0), cells(1));
  result.width = bitmap.width * cell;
  result.height = bitmap.height * cell;
  result.shift = result.shift + Vec2{1.0 * reach * cell, 1.0 * reach * cell};

  for (const auto& t : shape.triangles)
    fill_touched(bitmap, placed(t, scale / cell, (1.0 / cell) * result.shift), reach);
  if (reach > 0) bitmap = spread_rows(bitmap, reach);
  result.stamps[0] = make_stamp(bitmap);
  result.stamps[1] = make_stamp(turn(bitmap));
  for (int k = 0; k < 2; ++k) result.stamps[k + 2] = half_turned(result.stamps[k]);
  return result;
}

Vec2 turned(const Footprint& footprint, unsigned quarter_turns, const Vec2& point) {
  const auto [x, y] = point;
  switch (quarter_turns % 4) {
    case 1:
      return {footprint.height - y, x};
    case 2:
      return {footprint.width - x, footprint.height - y};
    case 3:
      return {y, footprint.width - x};
    default:
      return point;
  }
}

}  // namespace sdm::atlas

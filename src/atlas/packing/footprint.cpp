#include "atlas/packing/footprint.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "atlas/packing/rasterise.h"
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

// Fills the cells that the closed segment touches, and `spread` more to the left and right.
void fill_touched(Bitmap& bitmap, const Vec2& a, const Vec2& b, std::uint32_t spread) {
  const auto [lo, hi] = std::minmax({a[1], b[1]});
  const double rows = bitmap.height - 1.0, columns = bitmap.width - 1.0;
  const auto first = static_cast<std::size_t>(std::clamp(std::floor(lo), 0.0, rows));
  const auto last = static_cast<std::size_t>(std::clamp(std::floor(hi), 0.0, rows));
  const auto x_at = [&](const Vec2& end, double top, double bottom) {
    const double line = std::clamp(end[1], top, bottom);
    return line == end[1] ? end[0] : a[0] + (line - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
  };
  for (std::size_t y = first; y <= last; ++y) {
    const double top = y == first ? lo : static_cast<double>(y);
    const double bottom = y == last ? hi : static_cast<double>(y) + 1;
    const auto [left, right] = std::minmax({x_at(a, top, bottom), x_at(b, top, bottom)});
    const auto begin = static_cast<std::size_t>(std::clamp(std::floor(left) - spread, 0.0, columns));
    const auto end = static_cast<std::size_t>(std::clamp(std::floor(right) + spread, 0.0, columns));
    std::fill(bitmap.row(y) + begin, bitmap.row(y) + end + 1, 1);
  }
}

/// Winding numbers at the centres of cells.
class Windings {
 public:
  explicit Windings(const Bitmap& bitmap)
      : width_(bitmap.width), height_(bitmap.height), turns_(bitmap.cells.size(), 0) {}

  // Adds a segment of closed curves.
  void add(const Vec2& a, const Vec2& b) {
    const auto [lo, hi] = std::minmax({a[1], b[1]});
    for (double y = std::max(0.0, std::ceil(lo - 0.5)); y + 0.5 < hi && y < height_; ++y) {
      const double x = a[0] + (y + 0.5 - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
      const double column = std::max(0.0, std::ceil(x - 0.5));
      if (column < width_)
        turns_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(column)] +=
            a[1] < b[1] ? 1 : -1;
    }
  }
  // Fills the cells around whose centres the curves wind.
  void fill(Bitmap& bitmap) const {
    for (std::size_t y = 0; y < height_; ++y) {
      int winding = 0;
      for (std::size_t x = 0; x < width_; ++x) {
        winding += turns_[y * width_ + x];
        bitmap.row(y)[x] |= winding != 0;
      }
    }
  }

 private:
  std::uint32_t width_, height_;
  std::vector<int> turns_;  ///< the change of the winding number from the cell to the left
};

// Fills the cells that the shape touches, and `spread` more to the left and right of its outline. A cell that
// the outline does not touch is inside or outside as a whole.
void fill_shape(Bitmap& bitmap, const Shape& shape, double scale, const Vec2& shift, std::uint32_t spread) {
  Windings windings(bitmap);
  for (const auto& [from, to] : shape.outline) {
    const Vec2 a = scale * from + shift, b = scale * to + shift;
    fill_touched(bitmap, a, b, spread);
    windings.add(a, b);
  }
  windings.fill(bitmap);
}

Bitmap spread_rows(const Bitmap& bitmap, std::uint32_t spread) {
  Bitmap result(bitmap.width, bitmap.height);
  for (std::uint32_t y = 0; y < bitmap.height; ++y)
    for (std::uint32_t from = y > spread ? y - spread : 0; from <= std::min(y + spread, bitmap.height - 1);
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
    return std::tuple(b.length, a.row, a.begin) < std::tuple(a.length, b.row, b.begin);
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
  const std::uint32_t spread = (gutter + cell - 1) / cell;  // of the gutter, in cells
  Footprint result;
  if (!owns_texel(shape, scale, {0, 0})) result.shift = centring_shift(shape, scale);
  const auto cells = [&](int k) {
    // A point on the line between two cells touches both.
    const double extent = (scale * shape.size[k] + result.shift[k]) / cell;
    return static_cast<std::uint32_t>(extent) + 1 + 2 * spread;
  };
  Bitmap bitmap(cells(0), cells(1));
  result.width = bitmap.width * cell;
  result.height = bitmap.height * cell;
  result.shift = result.shift + Vec2{1.0 * spread * cell, 1.0 * spread * cell};

  fill_shape(bitmap, shape, scale / cell, (1.0 / cell) * result.shift, spread);
  if (spread > 0) bitmap = spread_rows(bitmap, spread);
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

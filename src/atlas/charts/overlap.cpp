#include "atlas/charts/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "atlas/charts/tangent_frame.h"
#include "core/arrays/rows.h"
#include "core/cancellation.h"

namespace sdm::atlas {
namespace {

struct Rectangle {
  GridPoint lower, upper;
};

Rectangle bounds_of(const GridTriangle& t) {
  Rectangle box{t[0], t[0]};
  for (const GridPoint& p : t)
    for (int k = 0; k < 2; ++k) {
      box.lower[k] = std::min(box.lower[k], p[k]);
      box.upper[k] = std::max(box.upper[k], p[k]);
    }
  return box;
}

bool boxes_meet(const Rectangle& a, const Rectangle& b) {
  return a.lower[0] < b.upper[0] && b.lower[0] < a.upper[0] && a.lower[1] < b.upper[1] &&
         b.lower[1] < a.upper[1];
}

// Whether an edge of `a` has all of `b` on its outer side.
bool separates(const GridTriangle& a, const GridTriangle& b, double slack) {
  for (int k = 0; k < 3; ++k) {
    const GridPoint &p = a[k], &q = a[(k + 1) % 3];
    const double limit = slack > 0 ? slack * std::hypot(q[0] - p[0], q[1] - p[1]) : 0;
    // The sign of an integer survives its rounding to double.
    const auto outside = [&](const GridPoint& r) {
      return static_cast<double>(orientation(p, q, r)) <= limit;
    };
    if (outside(b[0]) && outside(b[1]) && outside(b[2])) return true;
  }
  return false;
}

// The separating axis theorem: disjoint interiors of convex polygons are separated along an edge of one of
// them.
bool interiors_meet(const GridTriangle& a, const GridTriangle& b, double slack) {
  return !separates(a, b, slack) && !separates(b, a, slack);
}

// A uniform grid over the triangles' bounds, with a list for each cell of the triangles whose boxes intersect
// it.
class Buckets {
 public:
  explicit Buckets(std::span<const Rectangle> boxes) {
    Rectangle all = boxes[0];
    for (const Rectangle& b : boxes)
      for (int k = 0; k < 2; ++k) {
        all.lower[k] = std::min(all.lower[k], b.lower[k]);
        all.upper[k] = std::max(all.upper[k], b.upper[k]);
      }
    origin_ = all.lower;
    const double width = std::max(1, all.upper[0] - all.lower[0]),
                 height = std::max(1, all.upper[1] - all.lower[1]);
    cell_ = std::max(1.0, std::sqrt(width * height / static_cast<double>(boxes.size())));
    // Cells are squares, so that long thin sets have few cells across, but there are at most a few cells per
    // triangle, and cells are not so small that the lists grow long.
    const auto limit = 8.0 * static_cast<double>(boxes.size()) + 64;
    for (;; cell_ *= 2) {
      columns_ = static_cast<std::int64_t>(width / cell_) + 1;
      rows_ = static_cast<std::int64_t>(height / cell_) + 1;
      double entries = static_cast<double>(columns_) * static_cast<double>(rows_);
      for (const Rectangle& b : boxes)
        entries += static_cast<double>(column(b.upper[0]) - column(b.lower[0]) + 1) *
                   static_cast<double>(row(b.upper[1]) - row(b.lower[1]) + 1);
      if (entries <= limit || (columns_ == 1 && rows_ == 1)) break;
    }
    fill(boxes);
  }

  [[nodiscard]] std::size_t cells() const { return lists_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> list(std::size_t cell) const { return lists_.of(cell); }
  [[nodiscard]] std::size_t cell_of(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(row(y) * columns_ + column(x));
  }

 private:
  [[nodiscard]] std::int64_t column(std::int32_t x) const {
    return static_cast<std::int64_t>((x - origin_[0]) / cell_);
  }
  [[nodiscard]] std::int64_t row(std::int32_t y) const {
    return static_cast<std::int64_t>((y - origin_[1]) / cell_);
  }

  void fill(std::span<const Rectangle> boxes) {
    const auto cells = static_cast<std::size_t>(columns_ * rows_);
    lists_ = make_rows<std::uint32_t, std::size_t>(cells, [&](const auto& put) {
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        for (std::int64_t y = row(boxes[i].lower[1]); y <= row(boxes[i].upper[1]); ++y)
          for (std::int64_t x = column(boxes[i].lower[0]); x <= column(boxes[i].upper[0]); ++x)
            put(static_cast<std::size_t>(y * columns_ + x), i);
    });
  }

  GridPoint origin_{};
  double cell_ = 1;
  std::int64_t columns_ = 1, rows_ = 1;
  CompressedRows<std::uint32_t, std::size_t> lists_;  // of each cell
};

using Pair = std::pair<std::size_t, std::size_t>;

// Passes pairs of triangles whose interiors intersect to `found`, until it returns true; after about `budget`
// tests, an arbitrary pair to `exhausted`.
template <class Found, class Exhausted>
void for_each_overlap(std::span<const GridTriangle> triangles, double slack, std::uint64_t budget,
                      const Found& found, const Exhausted& exhausted) {
  std::vector<std::size_t> solid;
  std::vector<Rectangle> boxes;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (orientation(triangles[i][0], triangles[i][1], triangles[i][2]) > 0) {
      solid.push_back(i);
      boxes.push_back(bounds_of(triangles[i]));
    }
  if (solid.size() < 2) return;

  const Buckets buckets(boxes);
  std::uint64_t pairs = 0;
  Poll due(256);
  for (std::size_t cell = 0; cell < buckets.cells(); ++cell) {
    const auto list = buckets.list(cell);
    // Starts with the last of the list: where layers overlap, a pair far apart in the list splits the stack
    // in the middle.
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
      due();
      if ((pairs += list.size() - i) > budget) {
        exhausted(Pair(solid[list[i]], solid[list.back()]));
        return;
      }
      for (std::size_t j = list.size() - 1; j > i; --j) {
        const Rectangle &a = boxes[list[i]], &b = boxes[list[j]];
        // Among the cells that two boxes share, only the one with the low corner of their intersection tests
        // the pair.
        if (!boxes_meet(a, b)) continue;
        if (buckets.cell_of(std::max(a.lower[0], b.lower[0]), std::max(a.lower[1], b.lower[1])) != cell)
          continue;
        const std::size_t first = solid[list[i]], second = solid[list[j]];
        if (interiors_meet(triangles[first], triangles[second], slack) && found(Pair(first, second))) return;
      }
    }
  }
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> find_overlap(std::span<const GridTriangle> triangles,
                                                                double slack, std::uint64_t budget) {
  std::optional<Pair> result;
  const auto take = [&](const Pair& pair) {
    result = pair;
    return true;
  };
  for_each_overlap(triangles, slack, budget, take, take);
  return result;
}

std::vector<std::pair<std::size_t, std::size_t>> find_overlaps(std::span<const GridTriangle> triangles,
                                                               std::size_t most, std::uint64_t budget) {
  std::vector<Pair> pairs;
  bool too_many = false;
  for_each_overlap(
      triangles, 0, budget,
      [&](const Pair& pair) {
        pairs.push_back(pair);
        return too_many = pairs.size() > most;
      },
      [&](const Pair&) { too_many = true; });
  if (too_many) pairs.clear();
  return pairs;
}

std::vector<GridTriangle> snap(const Mesh& mesh, const Chart& chart) {
  const auto [right, up] = tangent_frame(chart.axis);
  const Vec3& origin = mesh.positions[mesh.triangles[chart.faces[0]][0]];
  std::vector<std::array<Vec2, 3>> projected;
  projected.reserve(chart.faces.size());
  Vec2 lo = {0, 0}, hi = {0, 0};
  for (const std::uint32_t f : chart.faces) {
    std::array<Vec2, 3>& corners = projected.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.positions[mesh.triangles[f][k]] - origin;
      corners[k] = {dot(p, right), dot(p, up)};
      for (int i = 0; i < 2; ++i) {
        lo[i] = std::min(lo[i], corners[k][i]);
        hi[i] = std::max(hi[i], corners[k][i]);
      }
    }
  }
  const double extent = std::max({hi[0] - lo[0], hi[1] - lo[1], std::numeric_limits<double>::min()});
  const auto step = [&](double x) { return static_cast<std::int32_t>(std::lround(x / extent * kGridSteps)); };
  std::vector<GridTriangle> snapped(projected.size());
  for (std::size_t i = 0; i < projected.size(); ++i)
    for (int k = 0; k < 3; ++k)
      snapped[i][k] = {step(projected[i][k][0] - lo[0]), step(projected[i][k][1] - lo[1])};
  return snapped;
}

}  // namespace sdm::atlas

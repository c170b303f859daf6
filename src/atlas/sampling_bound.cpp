// A face is the union of its pieces: the convex polygons that the squares of the texels cut from it. For one
// sample s the distance |p − s| is convex in p, so over a piece it is largest at a corner of the piece, and
//
//     sup over p in the surface of min over s of |p − s|  ≤  max over pieces of min over some s of max over
//     corners |c − s|.
//
// Any choice of samples gives a valid bound. For a square that the face owns, the texel's own sample is its
// centre: the bound is half the longer diagonal of the square, the same for all of them. For the others,
// those along borders, we try the samples of the texels around, which are near unless the chart is thin, and
// then the nearest sample in space, which may be across a seam. A piece that cannot raise the maximum found
// so far is left as soon as one sample shows it; so the result does not depend on the order of the faces.
#include "atlas/sampling_bound.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "atlas/sample_tree.h"
#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

/// A convex polygon: a triangle gains at most one corner from each of the four lines of a square.
template <class Point>
struct Polygon {
  std::array<Point, 7> corners{};
  int count = 0;

  void add(const Point& p) { corners[count++] = p; }
  [[nodiscard]] std::span<const Point> span() const {
    return {corners.data(), static_cast<std::size_t>(count)};
  }
};

/// The part of the polygon where side · (p[axis] − line) ≥ 0; side is 1 or −1.
Polygon<Vec2> clip(const Polygon<Vec2>& polygon, int axis, double line, double side) {
  Polygon<Vec2> out;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec2 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    const double da = side * (a[axis] - line), db = side * (b[axis] - line);
    if (da >= 0) out.add(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) out.add(a + (da / (da - db)) * (b - a));
  }
  return out;
}

std::array<double, 2> range(const Polygon<Vec2>& polygon, int axis) {
  const auto [lo, hi] = std::ranges::minmax(polygon.span(), {}, [axis](const Vec2& p) { return p[axis]; });
  return {lo[axis], hi[axis]};
}

/// Half the longer diagonal of a texel's square on the face: the farthest that it gets from its centre.
double half_diagonal(const Surface& surface, std::uint32_t face) {
  const auto [du, dv] = surface.texel_edges(face);
  return 0.5 * std::sqrt(std::max(squared_norm(du + dv), squared_norm(du - dv)));
}

class Bound {
 public:
  explicit Bound(const Surface& surface)
      : surface_(surface),
        resolution_(surface.resolution()),
        largest_(largest_half_diagonal(surface)),
        // A few texels: runs that jump to another chart are cut.
        tree_(surface, 16 * largest_) {}

  double compute() {
    parallel_for(surface_.mesh().triangles.size(), 256, [this](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        const auto face = static_cast<std::uint32_t>(f);
        surface_.face_charts()[face] == kNone ? add_degenerate_face(face) : add_face(face);
      }
    });
    // Corners of pieces are computed with a few roundings, each relative to the coordinates of the mesh or
    // the atlas.
    const Box box = bounds(surface_.mesh());
    double largest_coordinate = 0;
    for (int k = 0; k < 3; ++k)
      largest_coordinate = std::max({largest_coordinate, std::abs(box.lo[k]), std::abs(box.hi[k])});
    return largest_ + 1e-14 * (largest_coordinate + resolution_ * largest_);
  }

 private:
  static double largest_half_diagonal(const Surface& surface) {
    double largest = 0;
    std::uint32_t last = kNone;
    for (const std::uint32_t texel : surface.samples()) {
      const std::uint32_t face = surface.texel_faces()[texel];
      if (face != last) largest = std::max(largest, half_diagonal(surface, face));
      last = face;
    }
    return largest;
  }

  void raise(double value) {
    double largest = largest_.load(std::memory_order_relaxed);
    while (value > largest && !largest_.compare_exchange_weak(largest, value, std::memory_order_relaxed)) {
    }
  }

  void add_face(std::uint32_t face) {
    const Mesh& mesh = surface_.mesh();
    Polygon<Vec2> mapped;
    // What M⁻¹ · M moves the corners by rounding (slivers have no well-defined plane) may be added at every
    // point.
    double mismatch = 0;
    for (const std::uint32_t v : mesh.triangles[face]) {
      const Vec3& p = mesh.positions[v];
      mapped.add(surface_.to_atlas(face, p));
      mismatch = std::max(mismatch, norm(surface_.to_surface(face, mapped.corners[mapped.count - 1]) - p));
    }
    bool owner = false;
    const auto [top, bottom] = range(mapped, 1);
    for (double y = std::floor(top); y <= bottom; ++y) {
      const Polygon<Vec2> row = clip(clip(mapped, 1, y, 1), 1, y + 1, -1);
      if (row.count == 0) continue;
      const auto [left, right] = range(row, 0);
      for (double x = std::floor(left); x <= right; ++x) {
        if (owner_of(x, y) == face)
          owner = true;
        else
          add_foreign_square(face, row, x, y, mismatch);
      }
    }
    if (owner) raise(half_diagonal(surface_, face) + mismatch);
  }

  /// The part of the face's row in the square at (x, y), whose centre lies outside of the face.
  void add_foreign_square(std::uint32_t face, const Polygon<Vec2>& row, double x, double y, double mismatch) {
    if (owner_of(x, y) != kNone) {
      Polygon<Vec3> square;
      for (const Vec2& corner : {Vec2{x, y}, Vec2{x + 1, y}, Vec2{x, y + 1}, Vec2{x + 1, y + 1}})
        square.add(surface_.to_surface(face, corner));
      if (farthest(square, sample_of(x, y)) + mismatch <= largest_) return;
    }
    const Polygon<Vec2> part = clip(clip(row, 0, x, 1), 0, x + 1, -1);
    Polygon<Vec3> piece;
    for (const Vec2& corner : part.span()) piece.add(surface_.to_surface(face, corner));
    if (piece.count == 0) return;
    double nearest = std::numeric_limits<double>::infinity();
    for (double j = y - 1; j <= y + 1; ++j)
      for (double i = x - 1; i <= x + 1; ++i) {
        if (owner_of(i, j) == kNone) continue;
        nearest = std::min(nearest, farthest(piece, sample_of(i, j)) + mismatch);
        if (nearest <= largest_) return;
      }
    raise(std::min(nearest, to_nearest_sample(piece) + mismatch));
  }

  /// A face without area is its longest edge, up to its height; we cut it into short pieces.
  void add_degenerate_face(std::uint32_t face) {
    const Mesh& mesh = surface_.mesh();
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = mesh.positions[mesh.triangles[face][k]];
    for (int k = 0; k < 2; ++k)  // the longest edge becomes p[0] p[1]
      if (squared_norm(p[1] - p[0]) < std::max(squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2])))
        std::rotate(p.begin(), p.begin() + 1, p.end());
    const Vec3 edge = p[1] - p[0];
    const double length = norm(edge);
    const double height =
        norm(cross(edge, p[2] - p[0])) / std::max(length, std::numeric_limits<double>::min());
    const int pieces = static_cast<int>(std::clamp(std::ceil(length / largest_), 1.0, 1024.0));
    for (int i = 0; i < pieces; ++i) {
      Polygon<Vec3> piece;
      piece.add(p[0] + (double(i) / pieces) * edge);
      piece.add(p[0] + (double(i + 1) / pieces) * edge);
      raise(to_nearest_sample(piece) + height);
    }
  }

  [[nodiscard]] double to_nearest_sample(const Polygon<Vec3>& piece) const {
    Vec3 sum{};
    for (const Vec3& corner : piece.span()) sum += corner;
    return farthest(piece, tree_.nearest((1.0 / piece.count) * sum));
  }

  static double farthest(const Polygon<Vec3>& piece, const Vec3& sample) {
    double squared = 0;
    for (const Vec3& corner : piece.span()) squared = std::max(squared, squared_norm(corner - sample));
    return std::sqrt(squared);
  }

  /// The face that owns the texel at (x, y), kNone outside of the image.
  [[nodiscard]] std::uint32_t owner_of(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < resolution_ && y < resolution_)) return kNone;
    return surface_.texel_faces()[texel_at(x, y)];
  }
  [[nodiscard]] std::uint32_t texel_at(double x, double y) const {
    return static_cast<std::uint32_t>(y) * resolution_ + static_cast<std::uint32_t>(x);
  }
  [[nodiscard]] Vec3 sample_of(double x, double y) const { return surface_.texel_point(texel_at(x, y)); }

  const Surface& surface_;
  const std::uint32_t resolution_;
  std::atomic<double> largest_;
  const SampleTree tree_;
};

}  // namespace

double sampling_bound(const Surface& surface) {
  if (surface.samples().empty()) return std::numeric_limits<double>::infinity();
  return Bound(surface).compute();
}

}  // namespace sdm

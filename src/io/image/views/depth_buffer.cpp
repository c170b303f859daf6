#include "io/image/views/depth_buffer.h"

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <utility>

namespace sdm::io {
namespace {

// Neighbouring faces round their common edge differently: without a margin, samples on it could be in
// neither.
constexpr double kSeam = 1e-6;  // samples

Vec2 flat(const Vec3& p) {
  return {p[0], p[1]};
}

/// The first sample whose centre is not before a place, which is at least 0.
inline std::uint32_t sample_from(double place) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(place + 0.5));
}

/// A line from one point to another that is not above it.
struct Edge {
  Vec2 from;
  double slope;  // columns per row

  Edge(const Vec3& upper, const Vec3& lower)
      : from(flat(upper)), slope(lower[1] > upper[1] ? (lower[0] - upper[0]) / (lower[1] - upper[1]) : 0) {}
  [[nodiscard]] double column(double y) const { return from[0] + slope * (y - from[1]); }
};

}  // namespace

Vec3 Projection::operator()(const Vec3& point) const {
  const Vec3 from = point - centre;
  return {0.5 * width + scale * dot(from, right), 0.5 * height - scale * dot(from, up), dot(from, towards)};
}

DepthBuffer::DepthBuffer(const Mesh& mesh, const Projection& projection)
    : width_(kSamples * projection.width),
      height_(kSamples * projection.height),
      tiles_across_((width_ + kTile - 1) / kTile),
      tile_at_(std::size_t{tiles_across_} * ((height_ + kTile - 1) / kTile), kEmpty) {
  corners_.reserve(mesh.positions.size());
  for (const Vec3& position : mesh.positions) {
    const Vec3 p = projection(position);
    corners_.push_back({kSamples * p[0], kSamples * p[1], p[2]});
  }
  tiles_.reserve(tile_at_.size() + 1);
  tiles_.emplace_back();
  draw_all(mesh);
}

void DepthBuffer::draw_all(const Mesh& mesh) {
  // Faces that are seen from the back are drawn last: in a closed mesh, others hide most of them.
  std::vector<std::uint32_t> backs;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const Triangle& triangle = mesh.triangles[face];
    if (is_removed(triangle)) continue;
    if (doubled_area(triangle) > 0)
      backs.push_back(face);
    else if (const std::optional<Extent> extent = extent_of(triangle))
      draw(face, triangle, *extent);
  }
  const std::vector<float> farthest = farthest_in_tiles();
  for (const std::uint32_t face : backs) {
    const Triangle& triangle = mesh.triangles[face];
    if (const std::optional<Extent> extent = extent_of(triangle); extent && !is_hidden(*extent, farthest))
      draw(face, triangle, *extent);
  }
}

std::optional<DepthBuffer::Extent> DepthBuffer::extent_of(const Triangle& triangle) const {
  const Vec3 &a = corners_[triangle[0]], &b = corners_[triangle[1]], &c = corners_[triangle[2]];
  Extent extent;
  extent.begin = std::max(std::min({a[0], b[0], c[0]}) - kSeam, 0.0);
  extent.end = std::min(std::max({a[0], b[0], c[0]}) + kSeam, 1.0 * width_);
  const double top = std::max(std::min({a[1], b[1], c[1]}) - kSeam, 0.0);
  const double bottom = std::min(std::max({a[1], b[1], c[1]}) + kSeam, 1.0 * height_);
  if (!(extent.begin < extent.end && top < bottom)) return {};
  extent.first_column = sample_from(extent.begin);
  extent.end_column = sample_from(extent.end);
  extent.first_row = sample_from(top);
  extent.end_row = sample_from(bottom);
  if (extent.first_column >= extent.end_column || extent.first_row >= extent.end_row) return {};
  extent.farthest = std::min({a[2], b[2], c[2]});
  extent.nearest = std::max({a[2], b[2], c[2]});
  return extent;
}

std::vector<float> DepthBuffer::farthest_in_tiles() const {
  std::vector<float> farthest(tiles_.size());
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    farthest[i] = tiles_[i][0].depth;
    for (const Seen& seen : tiles_[i]) farthest[i] = std::min(farthest[i], seen.depth);
  }
  return farthest;
}

bool DepthBuffer::is_hidden(const Extent& extent, const std::vector<float>& farthest) const {
  // No sample of the face is nearer than this, as rounding is monotonic.
  const auto nearest = static_cast<float>(extent.nearest);
  for (std::uint32_t row = extent.first_row / kTile; row <= (extent.end_row - 1) / kTile; ++row)
    for (std::uint32_t column = extent.first_column / kTile; column <= (extent.end_column - 1) / kTile;
         ++column) {
      const std::uint32_t tile = tile_at_[std::size_t{row} * tiles_across_ + column];
      if (tile >= farthest.size() || !(nearest < farthest[tile])) return false;
    }
  return true;
}

void DepthBuffer::draw(std::uint32_t face, const Triangle& triangle, const Extent& extent) {
  const std::array<Vec3, 3> p{corners_[triangle[0]], corners_[triangle[1]], corners_[triangle[2]]};
  const double area = doubled_area(triangle);
  if (area == 0) return;                                    // seen edge-on
  std::array<const Vec3*, 3> down{p.data(), &p[1], &p[2]};  // from the highest corner to the lowest
  if ((*down[1])[1] < (*down[0])[1]) std::swap(down[0], down[1]);
  if ((*down[2])[1] < (*down[1])[1]) std::swap(down[1], down[2]);
  if ((*down[1])[1] < (*down[0])[1]) std::swap(down[0], down[1]);
  const double middle = (*down[1])[1];

  // The depth is linear: depth = at + by_x · x + by_y · y.
  const Vec3 a = p[1] - p[0], b = p[2] - p[0];
  const double by_x = (a[2] * b[1] - b[2] * a[1]) / area, by_y = (b[2] * a[0] - a[2] * b[0]) / area;
  const double at = p[0][2] - by_x * p[0][0] - by_y * p[0][1];

  // A row lies between the edge from the highest to the lowest corner and one of the two others.
  const Edge whole(*down[0], *down[2]), upper(*down[0], *down[1]), lower(*down[1], *down[2]);
  const bool to_right = cross(flat(*down[2]) - flat(*down[0]), flat(*down[1]) - flat(*down[0])) < 0;
  for (std::uint32_t row = extent.first_row; row < extent.end_row; ++row) {
    const double y = row + 0.5;
    const double here = whole.column(y), other = (y < middle ? upper : lower).column(y);
    const double from = (to_right ? here : other) - kSeam, to = (to_right ? other : here) + kSeam;
    std::uint32_t column = sample_from(std::min(extent.end, std::max(extent.begin, from)));
    const std::uint32_t end = sample_from(std::max(extent.begin, std::min(extent.end, to)));
    const double depth_of_row = at + by_y * y;
    while (column < end) {
      std::uint32_t& tile = tile_at_[place_of_tile(column, row)];
      if (tile == kEmpty) {
        tile = static_cast<std::uint32_t>(tiles_.size());
        tiles_.emplace_back();
      }
      Seen* seen = &tiles_[tile][in_tile(column, row)];
      const std::uint32_t end_in_tile = std::min(end, (column / kTile + 1) * kTile);
      for (; column < end_in_tile; ++column, ++seen) {
        const auto depth = static_cast<float>(
            std::clamp(depth_of_row + by_x * (column + 0.5), extent.farthest, extent.nearest));
        // Faces at equal depths: the first one is seen, in whatever order they are drawn.
        if (depth > seen->depth || (depth == seen->depth && face < seen->face)) *seen = {depth, face};
      }
    }
  }
}

double DepthBuffer::doubled_area(const Triangle& triangle) const {
  const Vec2 p = flat(corners_[triangle[0]]);
  return cross(flat(corners_[triangle[1]]) - p, flat(corners_[triangle[2]]) - p);
}

DepthBuffer::Point DepthBuffer::point(const Vec2& at, const Triangle& triangle) const {
  const Vec2 p = flat(corners_[triangle[0]]);
  const Vec2 a = flat(corners_[triangle[1]]) - p, b = flat(corners_[triangle[2]]) - p, x = at - p;
  const double area = cross(a, b);
  const double u = std::clamp(cross(x, b) / area, 0.0, 1.0), v = std::clamp(cross(a, x) / area, 0.0, 1 - u);
  return {.weights = {1 - u - v, u, v}, .is_back = area > 0};
}

}  // namespace sdm::io

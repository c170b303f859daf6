#include "io/image/views/depth_buffer.h"

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/vec.h"

namespace sdm::io {
namespace {

Vec2 flat(const Vec3& p) {
  return {p[0], p[1]};
}

/// The samples whose centres are from `lo` to `hi`, of `count`: from `first` up to before `second`.
inline std::pair<std::uint32_t, std::uint32_t> samples(double lo, double hi, std::uint32_t count) {
  // Both ends are rounded by a conversion to int, which is one instruction; std::ceil() is a call.
  const double most = count;
  const double first = std::clamp(lo - 0.5, -1.0, most), last = std::clamp(hi - 0.5, -1.0, most - 1);
  const auto begin = std::max(0, static_cast<int>(first) + (first > static_cast<int>(first) ? 1 : 0));
  const auto end = static_cast<int>(last + 1);  // not negative: rounded down
  return begin < end ? std::pair(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end))
                     : std::pair(0u, 0u);
}

}  // namespace

Vec3 Projection::operator()(const Vec3& point) const {
  const Vec3 from = point - centre;
  return {0.5 * width + scale * dot(from, right), 0.5 * height - scale * dot(from, up), dot(from, towards)};
}

DepthBuffer::DepthBuffer(const Mesh& mesh, const Projection& projection)
    : width_(kSamples * projection.width),
      height_(kSamples * projection.height),
      depth_(std::size_t{width_} * height_, -std::numeric_limits<float>::infinity()),
      face_(depth_.size(), kNone) {
  corners_.reserve(mesh.positions.size());
  for (const Vec3& position : mesh.positions) {
    const Vec3 p = projection(position);
    corners_.push_back({kSamples * p[0], kSamples * p[1], p[2]});
  }
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    if (!is_removed(mesh.triangles[face])) draw(face, mesh.triangles[face]);
}

void DepthBuffer::draw(std::uint32_t face, const Triangle& triangle) {
  // Neighbouring faces round their common edge differently: without a margin, samples on it could be in
  // neither.
  constexpr double kMargin = 1e-6;  // samples
  const std::array<Vec3, 3> p{corners_[triangle[0]], corners_[triangle[1]], corners_[triangle[2]]};
  const auto [left, right] = std::minmax({p[0][0], p[1][0], p[2][0]});
  const auto [top, bottom] = std::minmax({p[0][1], p[1][1], p[2][1]});
  const auto [farthest, nearest] = std::minmax({p[0][2], p[1][2], p[2][2]});
  if (!(right > 0 && left < width_ && bottom > 0 && top < height_)) return;  // outside of the picture
  const auto [first_row, end_row] = samples(top - kMargin, bottom + kMargin, height_);
  const auto columns = samples(left - kMargin, right + kMargin, width_);
  if (first_row == end_row || columns.first == columns.second) return;  // between samples
  const double area = cross(flat(p[1]) - flat(p[0]), flat(p[2]) - flat(p[0]));
  if (area == 0) return;  // seen edge-on
  const double side = area > 0 ? 1 : -1;

  // The depth is linear: depth = at + by_x · x + by_y · y.
  const Vec3 a = p[1] - p[0], b = p[2] - p[0];
  const double by_x = (a[2] * b[1] - b[2] * a[1]) / area, by_y = (b[2] * a[0] - a[2] * b[0]) / area;
  const double at = p[0][2] - by_x * p[0][0] - by_y * p[0][1];

  std::array<double, 3> slope{}, per_row{};  // by how many columns an edge moves from row to row
  for (int k = 0; k < 3; ++k) {
    const Vec3 &from = p[k], &to = p[(k + 1) % 3];
    slope[k] = side * (from[1] - to[1]);
    if (slope[k] != 0) per_row[k] = (to[0] - from[0]) / (to[1] - from[1]);
  }
  for (std::uint32_t row = first_row; row < end_row; ++row) {
    // The columns where the row's samples are on the inner side of all three edges.
    const double y = row + 0.5;
    double begin = left - kMargin, end = right + kMargin;
    for (int k = 0; k < 3; ++k) {
      const double column = p[k][0] + per_row[k] * (y - p[k][1]);
      if (slope[k] > 0)
        begin = std::max(begin, column - kMargin);
      else if (slope[k] < 0)
        end = std::min(end, column + kMargin);
    }
    const auto [first, last] = samples(begin, end, width_);
    for (std::uint32_t column = first; column < last; ++column) {
      const auto depth =
          static_cast<float>(std::clamp(at + by_x * (column + 0.5) + by_y * y, farthest, nearest));
      const std::size_t sample = std::size_t{row} * width_ + column;
      if (depth > depth_[sample]) depth_[sample] = depth, face_[sample] = face;
    }
  }
}

bool DepthBuffer::is_back(const Triangle& triangle) const {
  const Vec2 p = flat(corners_[triangle[0]]);
  return cross(flat(corners_[triangle[1]]) - p, flat(corners_[triangle[2]]) - p) > 0;  // rows count downwards
}

Vec3 DepthBuffer::weights(std::size_t sample, const Triangle& triangle) const {
  const std::size_t row = sample / width_, column = sample % width_;
  const Vec2 at{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
  const Vec2 p = flat(corners_[triangle[0]]);
  const Vec2 a = flat(corners_[triangle[1]]) - p, b = flat(corners_[triangle[2]]) - p, x = at - p;
  const double area = cross(a, b);
  const double u = std::clamp(cross(x, b) / area, 0.0, 1.0), v = std::clamp(cross(a, x) / area, 0.0, 1 - u);
  return {1 - u - v, u, v};
}

}  // namespace sdm::io

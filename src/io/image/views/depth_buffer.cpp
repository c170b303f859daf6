#include "io/image/views/depth_buffer.h"

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/vec.h"

namespace sdm::io {
namespace {

Vec2 flat(const Vec3& p) {
  return {p[0], p[1]};
}

/// The first sample whose centre is not before a place, which is at least 0.
inline std::int32_t sample_from(double place) {
  return static_cast<std::int32_t>(place + 0.5);
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
      seen_(std::size_t{width_} * height_) {
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
  const double begin = std::max(left - kMargin, 0.0), end = std::min(right + kMargin, 1.0 * width_);
  if (!(begin < end && sample_from(begin) < sample_from(end))) return;  // outside, or between samples
  std::array<const Vec3*, 3> down{p.data(), &p[1], &p[2]};  // from the highest corner to the lowest
  if ((*down[1])[1] < (*down[0])[1]) std::swap(down[0], down[1]);
  if ((*down[2])[1] < (*down[1])[1]) std::swap(down[1], down[2]);
  if ((*down[1])[1] < (*down[0])[1]) std::swap(down[0], down[1]);
  const double middle = (*down[1])[1];
  const double top = std::max((*down[0])[1] - kMargin, 0.0);
  const double bottom = std::min((*down[2])[1] + kMargin, 1.0 * height_);
  if (!(top < bottom)) return;
  const std::int32_t first_row = sample_from(top), end_row = sample_from(bottom);
  if (first_row >= end_row) return;
  const double area = cross(flat(p[1]) - flat(p[0]), flat(p[2]) - flat(p[0]));
  if (area == 0) return;  // seen edge-on

  // The depth is linear: depth = at + by_x · x + by_y · y.
  const auto [farthest, nearest] = std::minmax({p[0][2], p[1][2], p[2][2]});
  const Vec3 a = p[1] - p[0], b = p[2] - p[0];
  const double by_x = (a[2] * b[1] - b[2] * a[1]) / area, by_y = (b[2] * a[0] - a[2] * b[0]) / area;
  const double at = p[0][2] - by_x * p[0][0] - by_y * p[0][1];

  // A row lies between the edge from the highest to the lowest corner and one of the two others.
  const Edge whole(*down[0], *down[2]), upper(*down[0], *down[1]), lower(*down[1], *down[2]);
  const bool to_right = cross(flat(*down[2]) - flat(*down[0]), flat(*down[1]) - flat(*down[0])) < 0;
  for (std::int32_t row = first_row; row < end_row; ++row) {
    const double y = row + 0.5;
    const double here = whole.column(y), other = (y < middle ? upper : lower).column(y);
    const double from = (to_right ? here : other) - kMargin, to = (to_right ? other : here) + kMargin;
    const std::int32_t first = sample_from(std::min(end, std::max(begin, from)));
    const std::int32_t last = sample_from(std::max(begin, std::min(end, to)));
    Seen* const seen = &seen_[static_cast<std::size_t>(row) * width_];
    const double depth_of_row = at + by_y * y;
    for (std::int32_t column = first; column < last; ++column) {
      const auto depth =
          static_cast<float>(std::clamp(depth_of_row + by_x * (column + 0.5), farthest, nearest));
      if (depth > seen[column].depth) seen[column] = {depth, face};
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

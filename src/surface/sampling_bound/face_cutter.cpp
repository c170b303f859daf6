#include "surface/sampling_bound/face_cutter.h"

#include <algorithm>
#include <cmath>

#include "geometry/triangle.h"

namespace sdm::surface {
namespace {

/// A sample within this many half diagonals is near enough: points across an edge may be as far as its
/// square.
constexpr double kNearEnough = 1.1;

// Half the diagonal of a square texel, if all the area were shared among the samples.
double typical_radius(const Surface& surface) {
  double doubled_area = 0;
  for (std::size_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    const auto [a, b, c] = corners_of(surface.mesh(), f);
    doubled_area += norm(cross(b - a, c - a));
  }
  return 0.5 * std::sqrt(doubled_area / static_cast<double>(surface.sample_texels().size()));
}

}  // namespace

// The base is the longest edge, and the height is at most half a square.
std::array<Vec2, 3> unfolded(const std::array<Vec3, 3>& vertices, double piece_length) {
  constexpr double kMostPieces = 1024;
  const auto edge = [&](int k) { return vertices[(k + 1) % 3] - vertices[k]; };
  int base = 0;  // the longest edge runs from this vertex to the next
  for (int k = 1; k < 3; ++k)
    if (squared_norm(edge(k)) > squared_norm(edge(base))) base = k;
  const double length = norm(edge(base));
  const double pieces = std::clamp(std::ceil(length / piece_length), 1.0, kMostPieces);
  const double foot = length > 0 ? -dot(edge((base + 2) % 3), edge(base)) / (length * length) : 0;
  std::array<Vec2, 3> triangle{};
  triangle[(base + 1) % 3] = {pieces, 0};
  triangle[(base + 2) % 3] = {std::clamp(foot, 0.0, 1.0) * pieces, 0.5};
  return triangle;
}

FaceCutter::FaceCutter(const Surface& surface)
    : surface_(surface), typical_(typical_radius(surface)), near_samples_(surface, typical_) {}

CutFace FaceCutter::face(std::uint32_t index) const {
  const SurfaceData& data = internals(surface_);
  const auto without = std::span<const std::uint32_t>(data.map_faces).subspan(data.texels());
  const auto own = std::ranges::lower_bound(without, index);
  const bool has_own = own != without.end() && *own == index;
  const double radius = data.face_samples[index] > 0 ? half_diagonal(surface_.texel_edges(index)) : typical_;
  return {index, corners_of(surface_.mesh(), index), kNearEnough * radius,
          has_own ? data.texels() + static_cast<std::uint32_t>(own - without.begin()) : kNone};
}

}  // namespace sdm::surface

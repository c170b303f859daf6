#include "surface/sampling_bound/face_cutter.h"

#include <algorithm>
#include <cmath>

#include "atlas/charts/face_geometry.h"
#include "geometry/triangle.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm::surface {

Outline::Outline(const std::array<Vec3, 3>& v, const Polygon& polygon) {
  for (const auto& [at, weights] : polygon.corners())
    corners_[count_++] = v[0] + weights[0] * (v[1] - v[0]) + weights[1] * (v[2] - v[0]);
}

Vec3 Outline::middle() const {
  Vec3 sum{};
  for (std::size_t i = 0; i < count_; ++i) sum += corners_[i];
  return (1.0 / static_cast<double>(count_)) * sum;
}

double Outline::farthest_from(const Vec3& s) const {
  double squared = 0;
  for (std::size_t i = 0; i < count_; ++i) squared = std::max(squared, squared_norm(corners_[i] - s));
  return std::sqrt(squared);
}

NearSamples::Choice NearSamples::choose(std::uint32_t face, std::uint32_t own, double x, double y,
                                        const Outline& outline, double enough) const {
  Choice best;
  const auto consider = [&](std::uint32_t texel) {
    if (texel == kNone) return;
    const double distance = outline.farthest_from(surface_.texel_point(texel));
    if (distance < best.distance) best = {texel, distance};
  };
  consider(own);
  consider(texel_at(x, y));
  for (int j = -1; j <= 1 && best.distance > enough; ++j)
    for (int i = -1; i <= 1; ++i) consider(texel_at(x + i, y + j));
  if (best.distance > enough) {
    const std::uint32_t texel = nearest_texel(outline);
    if (best.texel == kNone || same_side(face, surface_.map_faces()[texel])) consider(texel);
  }
  return best;
}

// A face with an opposite normal may be in contact now, but may move independently, unless they share
// a vertex.
bool NearSamples::same_side(std::uint32_t face, std::uint32_t other) const {
  for (const std::uint32_t v : surface_.mesh().triangles[face])
    if (std::ranges::find(surface_.mesh().triangles[other], v) != surface_.mesh().triangles[other].end())
      return true;
  const auto normal = [this](std::uint32_t f) {
    const auto& [a, b, c] = surface_.mesh().triangles[f];
    const std::vector<Vec3>& positions = surface_.mesh().positions;
    return atlas::face_normal(positions[a], positions[b], positions[c]);
  };
  return dot(normal(face), normal(other)) > -0.5;
}

std::uint32_t NearSamples::texel_at(double x, double y) const {
  const double n = surface_.resolution();
  if (!(x >= 0 && y >= 0 && x < n && y < surface_.rows())) return kNone;
  const auto texel = static_cast<std::uint32_t>(y * n + x);
  return surface_.texel_faces()[texel] == kNone ? kNone : texel;
}

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

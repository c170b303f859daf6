#include "surface/sampling_bound/near_samples.h"

#include <algorithm>

#include "atlas/charts/face_geometry.h"
#include "geometry/vec.h"

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

}  // namespace sdm::surface

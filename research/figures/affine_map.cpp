#include "research/figures/affine_map.h"

#include <cmath>

namespace sdm::figures {

AffineMap affine_map(const Surface& surface, std::uint32_t face) {
  const auto& [i, j, k] = surface.mesh().triangles[face];
  const auto& p = surface.mesh().positions;
  const auto [a, b, c] = surface.atlas_corners(face);
  // In the plane of the face, with the first edge along x, the corners are (0, 0), (length, 0) and (x, y); in
  // the atlas, with the image of that edge along x, (0, 0), (image, 0) and (u, v). A_s maps the ones to the
  // others.
  const Vec3 edge = p[j] - p[i], other = p[k] - p[i];
  const double length = norm(edge), x = dot(other, edge) / length, y = norm(cross(edge, other)) / length;
  const Vec2 edge_image = b - a, other_image = c - a;
  const double image = std::hypot(edge_image[0], edge_image[1]);
  const double u = dot(other_image, edge_image) / image, v = std::abs(cross(edge_image, other_image)) / image;
  const double sx = image / length, sy = v / y;
  return {sx, sy, (u - sx * x) / v};
}

Vec2 texel_centre(const Surface& surface, std::uint32_t texel) {
  const std::uint32_t column = texel % surface.resolution(), row = texel / surface.resolution();
  return {column + 0.5, row + 0.5};
}

}  // namespace sdm::figures

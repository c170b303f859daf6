#include "gl/face_domains.h"

#include <algorithm>

namespace sdm::gl {
namespace {

Vec2 centre(std::uint32_t texel, std::uint32_t resolution) {
  const std::uint32_t column = texel % resolution, row = texel / resolution;
  return {column + 0.5, row + 0.5};
}

// The corners of the face in the atlas.
std::array<Vec2, 3> atlas_corners(const Surface& surface, std::uint32_t face) {
  std::array<Vec2, 3> corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = surface.to_atlas(face, surface.mesh().positions[surface.mesh().triangles[face][k]]);
  return corners;
}

}  // namespace

PlanarDomain face_domain(const Surface& surface, const surface::Tiles& tiles, std::uint32_t tile,
                         const UnitFrame& frame, GlClip clip) {
  const std::uint32_t face = tiles.faces[tile];
  const std::span<const std::uint32_t> texels = tiles.of(tile);
  PlanarDomain domain;
  domain.id = face;
  domain.image_origin = centre(texels.front(), surface.resolution());
  domain.origin = frame.to_unit(surface.texel_point(texels.front()));
  const std::array<Vec3, 2> edges = surface.texel_edges(face);
  for (int k = 0; k < 2; ++k) domain.edges[k] = frame.scale * edges[k];

  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const std::uint32_t texel : texels) {
    const Vec2 c = centre(texel, surface.resolution());
    for (int k = 0; k < 2; ++k) {
      lower[k] = std::min(lower[k], c[k]);
      upper[k] = std::max(upper[k], c[k]);
    }
  }
  domain.outline = ConvexPolygon::rectangle(lower - Vec2{kMargin, kMargin}, upper + Vec2{kMargin, kMargin});
  if (clip == GlClip::stencil) return domain;

  // Cuts parallel to the sides, but through the outermost texels instead of the sides themselves: tighter,
  // and guaranteed to contain every texel however the side was rounded.
  const std::array<Vec2, 3> corner = atlas_corners(surface, face);
  for (int k = 0; k < 3; ++k) {
    const Vec2 side = corner[(k + 1) % 3] - corner[k];
    const double length = std::sqrt(dot(side, side));
    const double turn = cross(side, corner[(k + 2) % 3] - corner[k]) > 0 ? 1 : -1;
    const Vec2 inward = (turn / length) * Vec2{-side[1], side[0]};
    if (!std::isfinite(inward[0]) || !std::isfinite(inward[1])) continue;
    double least = kInfinity;
    for (const std::uint32_t texel : texels)
      least = std::min(least, dot(inward, centre(texel, surface.resolution())));
    domain.outline.cut({kMargin - least, inward});
  }
  return domain;
}

}  // namespace sdm::gl

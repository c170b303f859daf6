// What the gl engine does differently from the paper's Algorithm 1 as it is printed. Each correction can be
// left out here, so that its effect can be measured (bench/paper_literal).
#pragma once

namespace sdm::literal {

struct Corrections {
  /// Line 8: sites are clipped by the walls of their region, not by the sides of its oriented box.
  bool region_walls = true;
  /// Line 10: the distance vector at a corner is that to the plane or line of the site, which is affine over
  /// the polygon. As printed it is that to the site itself, which is affine within the region only.
  bool affine_vectors = true;
  /// Lines 12 and 13: fragments evaluate the vector at the centre of their texel, instead of interpolating
  /// those of the corners. Requires affine_vectors.
  bool fragment_vectors = true;
  /// Walls are moved outwards, so that rounding opens no cracks between polygons, and fragments decide which
  /// texels lie inside the walls of a region.
  bool margins = true;
  /// Polygons are drawn on tiles of a face, not on its whole plane.
  bool tiles = true;
  /// The stencil of a face is drawn as the texels that it owns, not as a triangle.
  bool stencil_points = true;
  /// After line 15: distances are recomputed from the sites drawn, in double precision, and texels whose site
  /// was not the closest, or that have none, by the cpu engine.
  bool confirmation = true;

  /// Algorithm 1 as it is printed.
  [[nodiscard]] static constexpr Corrections none() {
    return {false, false, false, false, false, false, false};
  }
};

}  // namespace sdm::literal

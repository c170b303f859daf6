// Distance functions drawn as meshes with a bounded error (Hoff et al. 1999 and 2001).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "research/fields/draw_span.h"
#include "research/fields/drawn_sites.h"

namespace sdm::fields {

/// Over a slice, the distance to the plane of a face is linear. That to the line of an edge is a cone over
/// the plane normal to it, and that to a vertex a hyperboloid over the slice. Both are drawn as meshes:
/// sectors, whose corners lie on the surface, and for vertices rings. As these functions are convex, what is
/// drawn is never below the distance.
class TessellatedDistance {
 public:
  /// Distances up to `largest` are drawn with an error of at most `error`, in the unit frame; others are
  /// larger than `largest`. Throws sdm::Error if the error is too small for single precision.
  TessellatedDistance(double error, double largest);

  /// As draw_span() for an edge or a vertex. For a vertex, the vector has the same z along the row.
  void draw_span(float* squared, std::uint32_t* winner, std::size_t count, const SpanVector& vector,
                 const DrawnSite& site);

 private:
  /// The radius at which the mesh has the value that it has at (x, y); at least the distance from (0, 0).
  [[nodiscard]] double radius(double x, double y) const;
  void place_rings(double height);
  /// √(r² + height²), interpolated between the rings.
  [[nodiscard]] double hyperboloid(double r, double height) const;

  double error_, largest_;
  std::vector<Vec2> directions_;  ///< of the middles of sectors, divided by the cosine of half a sector
  std::vector<double> rings_;     ///< radii
};

}  // namespace sdm::fields

// Samples near a piece of a face.
#pragma once

#include <sdm/surface.h>

#include "surface/sampling_bound/polygon.h"
#include "surface/sampling_bound/sample_tree.h"

namespace sdm::surface {

/// The corners of a polygon in space.
class Outline {
 public:
  Outline(const std::array<Vec3, 3>& vertices, const Polygon& polygon);

  [[nodiscard]] Vec3 middle() const;
  /// The largest distance from s to any of its points: that of a corner, as |p − s| is convex in p.
  [[nodiscard]] double farthest_from(const Vec3& s) const;

 private:
  std::array<Vec3, Polygon::kMostCorners> corners_;
  std::size_t count_ = 0;
};

/// Chooses samples for pieces. Samples around the piece in the atlas will move along with it; near a seam,
/// the nearest sample in space may be closer.
class NearSamples {
 public:
  /// `radius` is about half a texel's diagonal. The surface must outlive this. Cost: linear in samples.
  NearSamples(const Surface& surface, double radius)
      : surface_(surface),
        // A few texels, so that runs that jump to another chart are cut.
        tree_(surface, 16 * radius) {}

  struct Choice {
    std::uint32_t texel = kNone;                                ///< the texel of the sample
    double distance = std::numeric_limits<double>::infinity();  ///< of the outline's farthest corner
  };
  /// Returns, for a piece of the face in the square of the texel at (x, y), the first sample found within
  /// `enough`, otherwise the nearest. `own`: the sample of a face without a texel, else kNone.
  [[nodiscard]] Choice choose(std::uint32_t face, std::uint32_t own, double x, double y,
                              const Outline& outline, double enough) const;
  /// The same for a piece of a face that is not in the atlas.
  [[nodiscard]] std::uint32_t nearest_texel(const Outline& outline) const {
    return surface_.sample_texels()[tree_.nearest(outline.middle())];
  }

  /// The texel whose square has its upper left corner at (x, y), if a face owns it, else kNone.
  [[nodiscard]] std::uint32_t texel_at(double x, double y) const;

 private:
  [[nodiscard]] bool same_side(std::uint32_t face, std::uint32_t other) const;

  const Surface& surface_;
  const SampleTree tree_;
};

}  // namespace sdm::surface

// Colours for distances.
#pragma once

#include <sdm/map_files.h>

#include <cstdint>
#include <optional>

#include "core/rules.h"

namespace sdm::io {

using rules::kAbove;
using rules::kBelow;
using rules::kNoValue;  ///< owned texels without a value, beyond the maximum distance
using rules::kUnjudged;
using rules::kWithin;
using rules::Rgb;

inline constexpr Rgb kBackground{222, 224, 228};  ///< texels that no face owns

/// A map from distances to colours, continuous except at the steps and edges of the tolerance bands, and at 0
/// if it is sequential.
struct ColorScale {
  Colormap map = Colormap::viridis;      ///< never automatic
  double lower = 0, upper = 1;           ///< lower < upper; colours are constant outside
  std::optional<Tolerance> tolerance{};  ///< if set, bands instead of the map
  double accuracy = 0;                   ///< distances that exceed the tolerance, or 0, by less are within it

  [[nodiscard]] Rgb operator()(double distance) const;

 private:
  [[nodiscard]] Rgb band(double distance) const;
};

/// The scale of `options`; what they leave open comes from the map, as fixed_colors() chooses it.
[[nodiscard]] ColorScale color_scale(const Surface& surface, const DistanceMap& map,
                                     const PictureOptions& options);
/// The scale of options that fixed_colors() returned.
[[nodiscard]] ColorScale color_scale(const PictureOptions& fixed);

/// A pseudorandom colour for each site: pale for faces, strong for edges, dark for vertices; kNoValue for
/// none.
[[nodiscard]] Rgb site_color(SiteType type, std::uint32_t site);

/// The colour of the unit vector along `vector`: (x, y, z) → (r, g, b) by (1 + x)/2; kNoValue if it is NaN.
[[nodiscard]] Rgb direction_color(const Vec3f& vector);

}  // namespace sdm::io

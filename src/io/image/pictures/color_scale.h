// Colours for distances.
#pragma once

#include <sdm/io.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace sdm::io {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

inline constexpr Rgb kBackground{222, 224, 228};  ///< texels that no face owns
inline constexpr Rgb kNoValue{128, 130, 134};  ///< owned texels without a value, beyond the maximum distance
inline constexpr Rgb kUnjudged{216, 206,
                               188};  ///< faces that no tolerance judges, beside those that one does

/// Within the tolerance, by the share of the way to the nearest limit: up to a quarter, a half, and so on.
/// They darken towards the limit and stay greener than the colours beyond, also for those who see green and
/// orange alike.
inline constexpr std::array<Rgb, 4> kWithin{
    {{225, 243, 233}, {176, 224, 199}, {122, 196, 161}, {66, 158, 122}}};
/// Beyond the tolerance, from its edge to the end of the scale.
inline constexpr std::array<Rgb, 3> kAbove{{{255, 214, 94}, {240, 120, 40}, {165, 15, 21}}};
inline constexpr std::array<Rgb, 3> kBelow{{{150, 200, 235}, {60, 130, 200}, {8, 48, 107}}};
/// The shorter side of a sequential scale, from 0 to its end: none is close to a colour of viridis.
inline constexpr std::array<Rgb, 3> kOpposite{{{255, 110, 80}, {225, 30, 40}, {130, 0, 20}}};

/// The colours of a colormap at equal steps, between which it is linear. Not of Colormap::automatic.
[[nodiscard]] std::span<const Rgb> colors_of(Colormap map);

/// A map from distances to colours, continuous except at the steps and edges of the tolerance bands, and at 0
/// if it is sequential.
struct ColorScale {
  Colormap map = Colormap::viridis;      ///< never automatic
  double lo = 0, hi = 1;                 ///< lo < hi; colours are constant outside
  std::optional<Tolerance> tolerance{};  ///< if set, bands instead of the map
  double accuracy = 0;                   ///< distances that exceed the tolerance, or 0, by less are within it

  [[nodiscard]] Rgb operator()(double distance) const;
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

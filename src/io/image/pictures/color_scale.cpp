#include "io/image/pictures/color_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sdm::io {
namespace {

// Ten equal steps of Matplotlib's viridis, and ColorBrewer's RdBu reversed with a pure white middle.
constexpr std::array<Rgb, 11> kViridis{{{68, 1, 84},
                                        {72, 36, 117},
                                        {65, 68, 135},
                                        {53, 95, 141},
                                        {42, 120, 142},
                                        {33, 145, 140},
                                        {34, 168, 132},
                                        {68, 191, 112},
                                        {122, 209, 81},
                                        {189, 223, 38},
                                        {253, 231, 37}}};
constexpr std::array<Rgb, 11> kDiverging{{{5, 48, 97},
                                          {33, 102, 172},
                                          {67, 147, 195},
                                          {146, 197, 222},
                                          {209, 229, 240},
                                          {255, 255, 255},
                                          {253, 219, 199},
                                          {244, 165, 130},
                                          {214, 96, 77},
                                          {178, 24, 43},
                                          {103, 0, 31}}};
constexpr std::array<Rgb, 3> kPaper2006{{{255, 0, 0}, {255, 255, 0}, {0, 255, 0}}};

// The nearest integer to `x` in [0, 255]. Not std::lround, which is a call for every channel of every texel.
std::uint8_t to_byte(float x) {
  return static_cast<std::uint8_t>(x + 0.5f);  // NOLINT(bugprone-incorrect-roundings): x is not negative
}

// Piecewise linear through equally spaced colours; t is clamped to [0, 1].
Rgb gradient(std::span<const Rgb> colors, double t) {
  const float s = static_cast<float>(std::clamp(t, 0.0, 1.0)) * static_cast<float>(colors.size() - 1);
  const int i = std::min(static_cast<int>(s), static_cast<int>(colors.size()) - 2);
  // Integers with 16 bits of fraction are faster than three conversions each way.
  const int f = static_cast<int>(65536 * (s - static_cast<float>(i)));
  const auto mix = [f](int a, int b) {
    return static_cast<std::uint8_t>((65536 * a + f * (b - a) + 32768) >> 16);
  };
  const Rgb &a = colors[i], &b = colors[i + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

// The position of `x` between `from` (0) and `to` (1).
double fraction(double x, double from, double to) {
  return to > from ? (x - from) / (to - from) : 1;
}

// How far a distance within the tolerance is on its way to the nearest limit, from 0 (at distance 0, or in
// the middle of a tolerance without it, or at the end of the scale where there is no limit) to 1.
double closeness(const ColorScale& scale, double d) {
  const auto [lower, upper] = *scale.tolerance;
  if (lower <= 0 && upper >= 0) return d == 0 ? 0 : d > 0 ? fraction(d, 0, upper) : fraction(-d, 0, -lower);
  const double room = std::isinf(upper)   ? scale.hi - lower
                      : std::isinf(lower) ? upper - scale.lo
                                          : (std::min(upper, scale.hi) - std::max(lower, scale.lo)) / 2;
  return room > 0 ? 1 - std::min(d - lower, upper - d) / room : 1;
}

Rgb within(const ColorScale& scale, double d) {
  const double step = std::floor(kWithin.size() * closeness(scale, d));
  return kWithin[static_cast<std::size_t>(std::clamp(step, 0.0, kWithin.size() - 1.0))];
}

// `hue` in [0, 1).
Rgb hsl(float hue, float saturation, float lightness) {
  const float chroma = saturation * std::min(lightness, 1 - lightness);
  const auto channel = [&](float n) {
    const float turned = n + 12 * hue, k = turned < 12 ? turned : turned - 12;
    return to_byte(255 * (lightness - chroma * std::clamp(std::min(k - 3, 9 - k), -1.0f, 1.0f)));
  };
  return {channel(0), channel(8), channel(4)};
}

// A bijection on 32-bit numbers in which every output bit depends on all input bits.
std::uint32_t scramble(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

}  // namespace

std::span<const Rgb> colors_of(Colormap map) {
  if (map == Colormap::diverging) return kDiverging;
  if (map == Colormap::paper2006) return kPaper2006;
  return kViridis;
}

Rgb ColorScale::operator()(double distance) const {
  if (!std::isfinite(distance)) return kNoValue;
  if (tolerance) {
    if (distance > tolerance->hi + accuracy) return gradient(kAbove, fraction(distance, tolerance->hi, hi));
    if (distance < tolerance->lo - accuracy)
      return gradient(kBelow, fraction(-distance, -tolerance->lo, -lo));
    return within(*this, distance);
  }
  if (map == Colormap::sequential) {
    const bool up = hi >= -lo;  // the longer side
    const double d = up ? distance : -distance;
    if (d < -accuracy) return gradient(kOpposite, fraction(-d, 0, up ? -lo : hi));
    return gradient(kViridis, fraction(d, std::max(0.0, up ? lo : -hi), up ? hi : -lo));
  }
  if (map == Colormap::diverging)
    return gradient(kDiverging, 0.5 + 0.5 * distance / std::max(std::abs(lo), std::abs(hi)));
  if (map == Colormap::paper2006) return gradient(kPaper2006, fraction(distance, lo, hi));
  return gradient(kViridis, fraction(distance, lo, hi));
}

ColorScale color_scale(const PictureOptions& fixed) {
  ColorScale scale{.map = fixed.colormap, .accuracy = fixed.accuracy};
  if (fixed.colormap == Colormap::automatic) scale.map = Colormap::viridis, scale.tolerance = fixed.tolerance;
  std::tie(scale.lo, scale.hi) = std::pair((*fixed.range)[0], (*fixed.range)[1]);
  return scale;
}

ColorScale color_scale(const Surface& surface, const DistanceMap& map, const PictureOptions& options) {
  const bool open = !options.range || (options.colormap == Colormap::automatic && !options.tolerance);
  return color_scale(fixed_colors(options, open ? statistics(surface, map) : DistanceStatistics{}));
}

Rgb site_color(SiteType type, std::uint32_t site) {
  if (type == SiteType::none) return kNoValue;
  const std::uint32_t hash = scramble(site * 4 + static_cast<std::uint32_t>(type));
  const float hue = static_cast<float>(hash >> 16) / 65536, vary = static_cast<float>(hash & 0xFFFF) / 65536;
  if (type == SiteType::face) return hsl(hue, 0.5f + 0.3f * vary, 0.74f + 0.12f * vary);
  if (type == SiteType::edge) return hsl(hue, 0.8f + 0.2f * vary, 0.5f + 0.1f * vary);
  return hsl(hue, 0.45f + 0.35f * vary, 0.26f + 0.14f * vary);
}

Rgb direction_color(const Vec3f& vector) {
  const double x = vector[0], y = vector[1], z = vector[2];
  const double length = std::sqrt(x * x + y * y + z * z);  // of floats: neither overflows nor vanishes
  if (std::isnan(length)) return kNoValue;
  // The zero vector has no direction: use the centre of the colour cube.
  const double scale = length > 0 ? 127.5 / length : 0;
  const auto channel = [scale](double v) { return to_byte(static_cast<float>(127.5 + scale * v)); };
  return {channel(x), channel(y), channel(z)};
}

}  // namespace sdm::io

namespace sdm {

ColorChoice color_choice(const PictureOptions& options) {
  return {options.colormap, options.range, options.tolerance, options.accuracy};
}

PictureOptions fixed_colors(const PictureOptions& options, const ColorRange& colors) {
  PictureOptions fixed = options;
  fixed.colormap = colors.colormap, fixed.range = colors.range;
  return fixed;
}

PictureOptions fixed_colors(const PictureOptions& options, const DistanceStatistics& distances) {
  return fixed_colors(options, color_range(color_choice(options), distances));
}

}  // namespace sdm

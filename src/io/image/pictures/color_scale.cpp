#include "io/image/pictures/color_scale.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

namespace sdm::io {
namespace {

// The nearest integer to `x` in [0, 255]. Not std::lround, which is a call for every channel of every texel.
std::uint8_t to_byte(float x) {
  return static_cast<std::uint8_t>(x + 0.5f);  // NOLINT(bugprone-incorrect-roundings): x is not negative
}

// Piecewise linear through equally spaced colours; t in [0, 1].
inline Rgb gradient(std::span<const Rgb> colors, double t) {
  const float s = static_cast<float>(t) * static_cast<float>(colors.size() - 1);
  const int i = std::min(static_cast<int>(s), static_cast<int>(colors.size()) - 2);
  // Integers with 16 bits of fraction are faster than three conversions each way.
  const int f = static_cast<int>(65536 * (s - static_cast<float>(i)));
  const auto mix = [f](int a, int b) {
    return static_cast<std::uint8_t>((65536 * a + f * (b - a) + 32768) >> 16);
  };
  const Rgb &a = colors[i], &b = colors[i + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

// The mode of rules::color_place() without bands.
double mode_of(const ColorScale& scale) {
  if (scale.map == Colormap::sequential) return rules::kSequential;
  return scale.map == Colormap::diverging ? rules::kCentred : rules::kEndToEnd;
}

// The colours of a colormap at equal steps, between which it is linear.
std::span<const Rgb> colors_of(Colormap map) {
  if (map == Colormap::diverging) return rules::kDiverging;
  if (map == Colormap::paper2006) return rules::kPaper2006;
  return rules::kViridis;
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

Rgb ColorScale::operator()(double distance) const {
  if (!std::isfinite(distance)) return kNoValue;
  if (tolerance) return band(distance);
  const double place = rules::color_place(distance, mode_of(*this), lower, upper, 0, 0, accuracy);
  if (place >= rules::kInOpposite) return gradient(rules::kOpposite, place - rules::kInOpposite);
  return gradient(colors_of(map), place);
}

Rgb ColorScale::band(double distance) const {
  const double place =
      rules::color_place(distance, rules::kBands, lower, upper, tolerance->lower, tolerance->upper, accuracy);
  if (place >= rules::kInUnjudged) return kUnjudged;
  if (place >= rules::kInBelow) return gradient(kBelow, place - rules::kInBelow);
  if (place >= rules::kInAbove) return gradient(kAbove, place - rules::kInAbove);
  return gradient(kWithin, place - rules::kInWithin);
}

ColorScale color_scale(const PictureOptions& fixed) {
  ColorScale scale{.map = fixed.colormap, .accuracy = fixed.accuracy};
  if (fixed.colormap == Colormap::automatic) {
    scale.map = Colormap::viridis;
    scale.tolerance = fixed.tolerance;
  }
  std::tie(scale.lower, scale.upper) = std::pair((*fixed.range)[0], (*fixed.range)[1]);
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
  fixed.colormap = colors.colormap;
  fixed.range = colors.range;
  return fixed;
}

PictureOptions fixed_colors(const PictureOptions& options, const DistanceStatistics& distances) {
  return fixed_colors(options, color_range(color_choice(options), distances));
}

std::array<std::uint8_t, 3> color_of(const PictureOptions& fixed, double distance) {
  const io::Rgb color = io::color_scale(fixed)(distance);
  return {color.r, color.g, color.b};
}

}  // namespace sdm

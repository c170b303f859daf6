#include <sdm/map_files.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <nlohmann/json.hpp>
#include <string>

#include "atlas/gutter.h"
#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/png.h"

namespace sdm {

using namespace io;

PictureOptions texture_range(const PictureOptions& options, const DistanceStatistics& distances) {
  PictureOptions plain = options;
  plain.tolerance = {};
  if (options.range) return fixed_colors(plain, distances);
  // A texture is data: no outlier is cut off, and nothing is rounded.
  double lo = distances.texels > 0 ? distances.min : 0, hi = distances.texels > 0 ? distances.max : 0;
  if (std::max(std::abs(lo), std::abs(hi)) <= options.accuracy) {
    lo = 0;
    hi = options.accuracy;
  }
  if (plain.colormap == Colormap::automatic)
    plain.colormap = lo < 0 && hi > 0 ? Colormap::diverging : Colormap::viridis;
  if (plain.colormap == Colormap::diverging) {
    hi = std::max(std::abs(lo), std::abs(hi));
    lo = -hi;
  }
  if (!(lo < hi)) hi = lo + (lo != 0 ? std::abs(lo) : 1);
  plain.range = {lo, hi};
  return plain;
}

TextureRange write_distance_texture(const std::filesystem::path& file, const Surface& surface,
                                    const DistanceMap& map, const PictureOptions& options) try {
  const bool open = !options.range || options.colormap == Colormap::automatic;
  const ColorScale scale =
      color_scale(texture_range(options, open ? statistics(surface, map) : DistanceStatistics{}));
  const std::uint32_t n = surface.resolution();
  const atlas::Gutter gutter(n, surface.texel_faces(), std::max(atlas::kGutter, surface.gutter()));
  constexpr double kWhite = 0xFFFF;
  const double factor = kWhite / (scale.upper - scale.lower);

  AtomicFile out(file);
  write_gray_png(out.stream(), n, surface.rows(), [&](std::uint32_t y, std::span<std::uint16_t> pixels) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t texel = gutter.source(x, y);
      const double d = texel == kNone ? scale.lower : map.distance[texel];
      const double value = !std::isfinite(d) ? 0 : std::clamp((d - scale.lower) * factor, 0.0, kWhite);
      pixels[x] = static_cast<std::uint16_t>(std::lround(value));
    }
  });
  out.commit();
  return {scale.lower, scale.upper};
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_texture_range(const std::filesystem::path& file, const std::string& texture,
                         const TextureRange& range, const std::string& units) {
  const nlohmann::ordered_json json{
      {"texture", texture},   {"bits", 16},     {"lower", range.lower},
      {"upper", range.upper}, {"units", units}, {"distance", "lower + value / 65535 * (upper - lower)"}};
  AtomicFile out(file);
  out.stream() << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::ignore) << '\n';
  out.commit();
}

}  // namespace sdm

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/image/pictures/atlas_picture.h"
#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/face_scales.h"
#include "io/image/pictures/legend.h"
#include "io/image/pictures/png.h"

#include <sdm/map_files.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace sdm {

using namespace io;

namespace {

// A picture of the atlas: color(texel) where a face owns the texel, otherwise the background; with a legend
// beside it.
template <class Color>
void write_map_png(const std::filesystem::path& file, const AtlasPicture& picture, Color&& color,
                   const Picture& legend = {}) {
  AtomicFile out(file);
  const std::uint32_t n = picture.width();
  write_png(out.stream(), n + legend.width, std::max(picture.height(), legend.height),
            [&](std::uint32_t y, std::span<Rgb> pixels) {
              const auto map_row = pixels.first(n), legend_row = pixels.subspan(n);
              std::fill(map_row.begin(), map_row.end(), kBackground);
              std::fill(legend_row.begin(), legend_row.end(), Rgb{255, 255, 255});
              if (y < picture.height())
                for (std::uint32_t x = 0; x < n; ++x)
                  if (const std::uint32_t texel = picture.texel(x, y); texel != kNone)
                    map_row[x] = color(texel);
              if (y < legend.height)
                std::copy_n(&legend.pixels[std::size_t{y} * legend.width], legend.width, legend_row.begin());
            });
  out.commit();
}

}  // namespace

void write_distance_png(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                        const PictureOptions& options) try {
  const ColorScale scale = color_scale(surface, map, options);
  const FaceScales of_faces(scale, options);
  const AtlasPicture picture(surface, options.largest);
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (const float d : std::span(map.distance).first(map.texels()))
    if (std::isfinite(d)) {
      least = std::min(least, d);
      most = std::max(most, d);
    }
  LegendText text = legend_text(map, least, most, scale, options.units);
  if (least <= most)  // views.png and the reports have those of the vertices too
    for (std::size_t i = 0; i < 2; ++i) text.notes[i] += " (texels)";
  of_faces.describe(text);
  write_map_png(
      file, picture,
      [&, owners = surface.texel_faces()](std::size_t texel) {
        return of_faces(owners[texel], map.distance[texel]);
      },
      draw_legend(of_faces.of_legend(), text, picture.height()));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_voronoi_png(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                       const PictureOptions& options) try {
  const AtlasPicture picture(surface, options.largest);
  write_map_png(
      file, picture, [&](std::size_t texel) { return site_color(map.site_type[texel], map.site[texel]); },
      draw_site_legend(picture.height(), map.beyond_max_distance + map.without_match > 0));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_direction_png(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                         const PictureOptions& options) try {
  write_map_png(file, AtlasPicture(surface, options.largest), [&](std::size_t texel) {
    return map.site_type[texel] == SiteType::none ? kNoValue : direction_color(map.vector[texel]);
  });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm

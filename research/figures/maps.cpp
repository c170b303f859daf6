#include "research/figures/maps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vec.h"
#include "io/image/pictures/legend.h"

namespace sdm::figures {
namespace {

constexpr io::Rgb kBodies[] = {{120, 164, 214}, {226, 170, 98}};

/// A common scale for both maps, so that a colour means the same distance on both bodies.
io::ColorScale common_scale(const Pair& pair) {
  io::ColorScale scale{
      .map = Colormap::paper2006, .lower = std::numeric_limits<double>::infinity(), .upper = 0};
  for (const Side& side : pair.sides) {
    const DistanceStatistics d = statistics(side.surface, side.map);
    scale.lower = std::min(scale.lower, d.min);
    scale.upper = std::max(scale.upper, d.max);
  }
  return scale;
}

std::array<Shown, 2> shown(const Pair& pair, bool inside) {
  return {Shown{&pair.sides[0].surface}, Shown{&pair.sides[1].surface, inside}};
}

}  // namespace

void Pair::compute(const std::shared_ptr<const Engine>& engine) {
  for (int b = 0; b < 2; ++b)
    compute_map(sides[b].surface, sides[1 - b].sites, {.engine = engine, .sign = SignMethod::none},
                sides[b].map);
}

double Pair::diagonal() const {
  Box box = bounds(sides[0].surface.mesh());
  extend(box, bounds(sides[1].surface.mesh()));
  return core::diagonal(box);
}

double Pair::error_at_samples() const {
  const MapOptions options{.engine = make_engine("reference"), .sign = SignMethod::none};
  double largest = 0;
  for (int b = 0; b < 2; ++b) {
    const Side& side = sides[b];
    const DistanceMap exact = compute_map(side.surface, sides[1 - b].sites, options);
    for (const std::uint32_t t : side.surface.sample_texels()) {
      const double error = std::abs(std::abs(side.map.distance[t]) - exact.distance[t]);
      largest = std::max(largest, std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
    }
  }
  return largest / diagonal();
}

MapPictures paint(const Pair& pair, const View& view, bool inside) {
  const Scenery scenery(view, shown(pair, inside));
  const io::ColorScale scale = common_scale(pair);
  const auto map = [&](const Seen& s) -> const DistanceMap& { return pair.sides[s.object].map; };
  return {scenery.paint([&](const Seen& s) { return scale(map(s).distance[s.texel]); }),
          scenery.paint(
              [&](const Seen& s) { return io::site_color(map(s).site_type[s.texel], map(s).site[s.texel]); }),
          scenery.paint([&](const Seen& s) { return io::direction_color(map(s).vector[s.texel]); }),
          io::draw_legend(scale, {"Distance", "m", {}, false}, view.height)};
}

io::Picture paint_bodies(const Pair& pair, const View& view, bool inside) {
  return Scenery(view, shown(pair, inside)).paint([](const Seen& s) { return kBodies[s.object]; });
}

}  // namespace sdm::figures

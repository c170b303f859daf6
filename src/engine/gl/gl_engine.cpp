#include "engine/gl/gl_engine.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "engine/gl/domain_tree.h"
#include "engine/gl/pair_stream.h"

namespace sdm {
namespace gl {
namespace {

// Tiles of O1 drawn together, at most. A site's region and box are made once for each block.
constexpr std::uint32_t kBlockTiles = 2048;

void check(const GlOptions& options) {
  if (options.stencil_values < 1 || options.stencil_values > 255)
    throw Error(std::to_string(options.stencil_values) + " stencil values are out of range; use 1 to 255");
}

// The devices of the process, by the requested name. One map is drawn at a time. They live as long as the
// process: at its end drivers may be gone before anything that could be destroyed.
struct Devices {
  std::mutex drawing;
  std::map<std::string, std::unique_ptr<RasterDevice>, std::less<>> open;
  TileTreeCache tiles;  // of the surfaces mapped by any of them
};

Devices& devices() {
  static Devices& all = *new Devices;
  return all;
}

// Calls use(device, ms) for the device wanted, with its context current. Opening it takes ms, once.
template <class Use>
auto with_device(const std::string& wanted, Use use) {
  Devices& all = devices();
  const std::lock_guard lock(all.drawing);
  Stopwatch watch;
  try {
    std::unique_ptr<RasterDevice>& device = all.open[wanted];
    if (!device) device = std::make_unique<RasterDevice>(wanted);
    const Context::Current current(device->context());
    return use(*device, watch.lap());
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    all.open.erase(wanted);  // it may be lost: the next map starts afresh
    throw;
  }
}

// How long lengths are, in the unit frame of O2.
struct Extent {
  double size;   // no coordinate is larger
  double reach;  // no sample is farther from O2

  Extent(const hierarchy::FloatBox& o1, const hierarchy::FloatBox& o2) : size(0), reach(0) {
    for (int k = 0; k < 3; ++k) {
      for (const hierarchy::FloatBox* box : {&o1, &o2})
        size = std::max({size, std::abs(double{box->lo[k]}), std::abs(double{box->hi[k]})});
      const double farthest = std::max(double{o1.hi[k]} - o2.lo[k], double{o2.hi[k]} - o1.lo[k]);
      reach += farthest * farthest;
    }
    reach = std::sqrt(reach);
  }
};

// Beyond this many sizes of O2 squares come near the end of single precision.
constexpr double kFarAway = 1e15;
// The rounding error of single precision relative to the scene's size; regions are enlarged by it.
constexpr double kRegionSlack = 0x1p-20;
// Distances that differ by less may be mistaken for each other, so bounds leave more.
constexpr double kBoundSlack = 0x1p-17;

void store(const PairCounts& counts, const SiteIndex& sites, const surface::Tiles& tiles, GlReport& report) {
  const std::uint64_t kept = sites.before.back();
  report.sites = kept + sites.dropped;
  report.sites_dropped = sites.dropped;
  report.tiles = tiles.count();
  for (std::size_t i = 0; i < tiles.faces.size(); ++i)
    report.faces += i == 0 || tiles.faces[i] != tiles.faces[i - 1];
  report.pairs = kept * report.tiles;
  report.bound_tests = counts.bound_tests;
  report.obb_tests = counts.obb_tests;
  report.culled_by_bound = counts.culled_by_bound;
  report.culled_by_obb = counts.culled_by_obb;
  report.clipped_away = counts.clipped_away;
  report.polygons = counts.polygons;
}

std::vector<PlanarDomain> domains_of(const DomainBlock& block, const DomainTree& tree, const Surface& surface,
                                     const surface::Tiles& tiles, const UnitFrame& frame, GlClip clip) {
  const std::uint32_t first = tree.leaves.before[block.node];
  std::vector<PlanarDomain> domains(tree.leaves.count(block.node, block.end));
  parallel_for(domains.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      domains[i] = face_domain(surface, tiles, tree.tree.items[first + i], frame, clip);
  });
  return domains;
}

RasterWinners draw_map(const RasterDevice& device, const Surface& surface, const sites::SitesData& sites,
                       const MapOptions& options, GlReport& report) {
  Stopwatch watch;
  const TileTree& tile_tree = devices().tiles.of(surface);
  const surface::Tiles& tiles = tile_tree.tiles;
  DomainTree tree(surface, tile_tree, sites.frame);
  const SiteIndex index(sites);
  report.time_ms.refit = watch.lap();

  const Extent extent(tree.root().box, sites.tree.nodes[0].box);
  if (!(extent.size < kFarAway))
    throw Error(
        "the distance of O1 exceeds 10^15 times the size of O2, too far for the gl engine; use another "
        "engine");
  const double slack = kBoundSlack * extent.size;
  const double farthest = std::min(extent.reach, sites.frame.scale * options.max_distance) + slack;
  if (options.raster.bound_culling)
    set_bounds(tree, sites, slack, farthest);
  else
    set_bounds(tree, farthest);
  const double reach = tree.bound[0];
  report.time_ms.bounds = watch.lap();

  const RasterScale scale{kRegionSlack * extent.size, std::exp2(-std::ceil(std::log2(reach)))};
  const Ownership owned =
      options.raster.clip == GlClip::planes
          ? Ownership(OwnerTable{surface.texel_faces()})
          : Ownership(StencilValues{tiles.face_offsets, tiles.texels, options.raster.stencil_values});
  Rasteriser rasteriser(device, surface.resolution(), owned);
  PairStream stream(index, tree, reach, scale, rasteriser, report.time_ms);
  report.time_ms.draw = watch.lap();

  std::vector<DomainBlock> blocks = cut_into_blocks(tree, kBlockTiles);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    DomainBlock& block = blocks[b];
    watch.lap();
    block.domains = domains_of(block, tree, surface, tiles, sites.frame, options.raster.clip);
    report.time_ms.refit += watch.lap();
    stream.draw(block, [&](double fraction) {
      const double done = (static_cast<double>(b) + fraction) / static_cast<double>(blocks.size());
      if (options.progress && !options.progress("raster", done)) throw Cancelled();
    });
    block.domains = {};
  }
  watch.lap();
  stream.finish();
  report.time_ms.draw += watch.lap();
  store(stream.counts(), index, tiles, report);

  RasterImage image = rasteriser.read_back();
  rasteriser.count_into(report);
  report.time_ms.read_back = watch.lap();
  return {.faces = std::move(image.faces),
          .depths = std::move(image.depths),
          .depth_unit = 1 / scale.to_depth / sites.frame.scale,
          .tolerance = 1.5 * scale.slack / sites.frame.scale};
}

void expect_no_cracks(const Surface& surface, const RasterWinners& winners, const MapOptions& options,
                      const GlReport& report) {
  if (options.max_distance < std::numeric_limits<double>::infinity()) return;
  for (const std::uint32_t texel : surface.sample_texels())
    if (winners.faces[texel] == kNone)
      throw Error(report.device.name + " left texel " + std::to_string(texel) +
                  " without a value, which OpenGL does not allow; use another device or engine");
}

}  // namespace
}  // namespace gl

GlDevice gl_device(const GlOptions& options, std::uint32_t resolution) {
  gl::check(options);
  return gl::with_device(options.device, [&](const gl::RasterDevice& device, double) {
    gl::Rasteriser::check_size(device.context(), resolution);
    return device.context().device();
  });
}

RasterWinners gl_winners(const Surface& surface, const Sites& sites, const MapOptions& options,
                         GlReport& report) {
  gl::check(options.raster);
  return gl::with_device(options.raster.device, [&](const gl::RasterDevice& device, double ms) {
    report.device = device.context().device();
    report.clip = options.raster.clip;
    report.texels = surface.sample_texels().size();
    report.time_ms.context = ms;
    RasterWinners winners = gl::draw_map(device, surface, internals(sites), options, report);
    gl::expect_no_cracks(surface, winners, options, report);
    return winners;
  });
}

}  // namespace sdm

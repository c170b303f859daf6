#include "gl/draw_winners.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "gl/domain_tree.h"
#include "gl/pair_stream.h"

namespace sdm::gl {
namespace {

// The most tiles of O1 drawn together. A site's region and box are computed once per such set.
constexpr std::uint32_t kBlockTiles = 2048;

// Bounds on lengths, in the unit frame of O2.
struct Extent {
  double size;   // no coordinate is larger
  double reach;  // no sample is farther from O2

  Extent(const tree::FloatBox& o1, const tree::FloatBox& o2) : size(0), reach(0) {
    for (int k = 0; k < 3; ++k) {
      for (const tree::FloatBox* box : {&o1, &o2})
        size = std::max({size, std::abs(double{box->lo[k]}), std::abs(double{box->hi[k]})});
      const double farthest = std::max(double{o1.hi[k]} - o2.lo[k], double{o2.hi[k]} - o1.lo[k]);
      reach += farthest * farthest;
    }
    reach = std::sqrt(reach);
  }
};

// Beyond this multiple of O2's size, squares approach the range of single precision.
constexpr double kFarAway = 1e15;
// The rounding error of single precision relative to the scene's size, by which regions are enlarged.
constexpr double kRegionSlack = 0x1p-20;
// Distances that differ by less may compare either way, so bounds are enlarged by this.
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

// The corners of the faces in the atlas, if their triangles are drawn into the stencil.
std::vector<std::array<float, 2>> stencil_corners(const Surface& surface) {
  std::vector<std::array<float, 2>> corners;
  const Mesh& mesh = surface.mesh();
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    for (const std::uint32_t vertex : mesh.triangles[face]) {
      const bool mapped = surface.face_charts()[face] != kNone;
      const Vec2 uv = mapped ? surface.to_atlas(face, mesh.positions[vertex]) : Vec2{};
      corners.push_back({static_cast<float>(uv[0]), static_cast<float>(uv[1])});
    }
  return corners;
}

void expect_no_cracks(const Surface& surface, std::span<const std::uint32_t> winners,
                      const GlReport& report) {
  for (const std::uint32_t texel : surface.sample_texels())
    if (winners[texel] == kNone)
      throw Error(report.device.name + " left texel " + std::to_string(texel) +
                  " without a value, which OpenGL does not allow; use another device or engine");
}

}  // namespace

RasterWinners draw_winners(const RasterDevice& device, const DrawTask& task, GlReport& report) {
  const auto& [surface, tile_tree, sites, gl, corrections, options] = task;
  const surface::Tiles& tiles = tile_tree.tiles;
  Stopwatch watch;
  DomainTree tree(surface, tile_tree, sites.frame);
  const SiteIndex index(sites);
  report.time_ms.refit = watch.lap();

  const Extent extent(tree.bounds(), sites.tree.box(0));
  if (!(extent.size < kFarAway))
    throw Error(
        "the distance of O1 exceeds 10^15 times the size of O2, too far for the gl engine; use another "
        "engine");
  const double slack = kBoundSlack * extent.size;
  const double farthest = std::min(extent.reach, sites.frame.scale * options.max_distance) + slack;
  if (gl.bound_culling)
    set_bounds(tree, sites, slack, farthest);
  else
    set_bounds(tree, farthest);
  const double reach = tree.bound[0];
  report.time_ms.bounds = watch.lap();

  // Vectors to sites are longer beyond their regions: within a box, up to √3 times its reach, twice.
  const double longest = corrections.region_walls ? reach : 4 * reach;
  const RasterRules rules{kRegionSlack * extent.size, std::exp2(-std::ceil(std::log2(longest))), corrections};
  const std::vector<std::array<float, 2>> corners =
      corrections.stencil_points ? std::vector<std::array<float, 2>>() : stencil_corners(surface);
  const Ownership owned =
      gl.clip == GlClip::planes
          ? Ownership(OwnerTable{surface.texel_faces()})
          : Ownership(StencilValues{tiles.face_offsets, tiles.texels, gl.stencil_values, corners});
  Rasteriser rasteriser(device, {surface.resolution(), surface.rows()}, owned, corrections);
  PairStream stream(index, tree, reach, rules, rasteriser, report.time_ms);
  report.time_ms.draw = watch.lap();

  std::vector<DomainBlock> blocks = cut_into_blocks(tree, kBlockTiles);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    DomainBlock& block = blocks[b];
    watch.lap();
    block.domains = domains_of(block, tree, surface, tiles, sites.frame, gl.clip);
    report.time_ms.refit += watch.lap();
    stream.draw(block, [&, &progress = options.progress](double fraction) {
      const double done = (static_cast<double>(b) + fraction) / static_cast<double>(blocks.size());
      if (progress && !progress("raster", done)) throw Cancelled();
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
  const bool complete = corrections.margins && corrections.stencil_points;
  if (complete && options.max_distance == std::numeric_limits<double>::infinity())
    expect_no_cracks(surface, image.winners, report);
  return {.winners = std::move(image.winners),
          .depths = std::move(image.depths),
          .vectors = std::move(image.vectors),
          .complete = complete,
          .depth_unit = 1 / rules.to_depth / sites.frame.scale,
          .tolerance = 1.5 * rules.slack / sites.frame.scale};
}

}  // namespace sdm::gl

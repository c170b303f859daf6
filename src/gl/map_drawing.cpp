#include "gl/map_drawing.h"
#include "gl/raster_report.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "gl/face_domains.h"

namespace sdm::gl {
namespace {

// Bounds on lengths, in the unit frame of O2.
struct Extent {
  double size;   // no coordinate is larger
  double reach;  // no sample is farther from O2

  Extent(const tree::FloatBox& o1, const tree::FloatBox& o2) : size(0), reach(0) {
    for (int k = 0; k < 3; ++k) {
      for (const tree::FloatBox* box : {&o1, &o2})
        size = std::max({size, std::abs(double{box->lower[k]}), std::abs(double{box->upper[k]})});
      const double farthest = std::max(double{o1.upper[k]} - o2.lower[k], double{o2.upper[k]} - o1.lower[k]);
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

}  // namespace

double depth_scale(double longest) {
  return std::exp2(-std::ceil(std::log2(longest)));
}

MapDrawing::MapDrawing(const DrawTask& task, RasterReport& report)
    : task_(task),
      report_(report),
      tree_(task.surface, task.tile_tree, task.sites.frame),
      index_(task.sites) {
  report.time_ms.refit = watch_.lap();
  const Extent extent(tree_.bounds(), task.sites.tree.box(0));
  if (!(extent.size < kFarAway))
    throw Error(
        "the distance of O1 exceeds 10^15 times the size of O2, too far for the gl engine; use another "
        "engine");
  slack_ = kRegionSlack * extent.size;
  const double slack = kBoundSlack * extent.size;
  const double farthest = std::min(extent.reach, task.sites.frame.scale * task.options.max_distance) + slack;
  if (task.gl.bound_culling)
    set_bounds(tree_, task.sites, slack, farthest);
  else
    set_bounds(tree_, farthest);
  report.time_ms.bounds = watch_.lap();
}

std::vector<PlanarDomain> MapDrawing::domains_of(const DomainBlock& block) const {
  const std::uint32_t first = tree_.leaves.before[block.node];
  std::vector<PlanarDomain> domains(tree_.leaves.count(block.node, block.end));
  parallel_for(domains.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      domains[i] = face_domain(task_.surface, task_.tile_tree.tiles, tree_.tree.items[first + i],
                               task_.sites.frame, task_.gl.clip);
  });
  return domains;
}

void MapDrawing::store(const PairCounts& counts) {
  const surface::Tiles& tiles = task_.tile_tree.tiles;
  const std::uint64_t kept = index_.before.back();
  report_.sites = kept + index_.dropped;
  report_.sites_dropped = index_.dropped;
  report_.tiles = tiles.count();
  for (std::size_t i = 0; i < tiles.faces.size(); ++i)
    report_.faces += i == 0 || tiles.faces[i] != tiles.faces[i - 1];
  report_.pairs = kept * report_.tiles;
  report_.bound_tests = counts.bound_tests;
  report_.obb_tests = counts.obb_tests;
  report_.culled_by_bound = counts.culled_by_bound;
  report_.culled_by_obb = counts.culled_by_obb;
  report_.clipped_away = counts.clipped_away;
  report_.polygons = counts.polygons;
}

}  // namespace sdm::gl

#include "research/fields/drawn_sites.h"

#include <sdm/error.h>

#include <cmath>

#include "core/memory.h"
#include "core/parallel.h"

namespace sdm::fields {
namespace {

// As of the gl engine: relative to the largest coordinate, so that the distances of a face, which are too
// short beyond its walls, are so by less than the error of its method.
constexpr double kRegionSlack = 0x1p-20, kBoundSlack = 0x1p-17;
// Beyond this multiple of O2's size, squares approach the range of single precision.
constexpr double kFarAway = 1e15;

template <class Visit>
void visit_interiors(const sites::SitesData& sites, std::size_t leaf, Visit&& visit) {
  gl::for_each_site(sites.regions, leaf, [&](const auto& region, std::size_t index) {
    if (gl::has_interior(region)) visit(region, index);
  });
}

}  // namespace

std::vector<DrawnSite> drawn_sites(const sites::SitesData& sites) {
  const std::size_t leaves = sites.regions.leaves.size() - 1;
  std::vector<std::size_t> first(leaves + 1, 0);
  parallel_for(leaves, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      visit_interiors(sites, leaf, [&](const auto&, std::size_t) { ++first[leaf + 1]; });
  });
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) first[leaf + 1] += first[leaf];
  require_memory(first.back() * sizeof(DrawnSite), "drawing " + std::to_string(first.back()) + " sites");
  std::vector<DrawnSite> drawn(first.back());
  parallel_for(leaves, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      std::size_t at = first[leaf];
      visit_interiors(sites, leaf, [&](const auto& source, std::size_t index) {
        SiteRegion region = gl::region_of(sites, source, index);
        const std::uint32_t code = site_code(region.type, region.site);
        const Box box = region.box();
        drawn[at++] = {std::move(region), box, code};
      });
    }
  });
  return drawn;
}

SliceRules::SliceRules(const DrawingTask& task, const UnitGrid& grid) {
  const tree::FloatBox& o2 = task.sites.tree.box(0);
  double size = 0, reach = 0;
  for (int k = 0; k < 3; ++k) {
    const double lower = grid.at(k, 0), upper = grid.at(k, grid.dims[k] - 1);
    size = std::max({size, std::abs(lower), std::abs(upper), std::abs(double{o2.lower[k]}),
                     std::abs(double{o2.upper[k]})});
    const double farthest = std::max(upper - o2.lower[k], o2.upper[k] - lower);
    reach += farthest * farthest;
  }
  if (!(size < kFarAway))
    throw Error("the grid reaches beyond 10^15 times the size of O2, too far for the method " +
                std::string(info(task.options.method).name) + "; use best");
  slack = kRegionSlack * size;
  margin = kBoundSlack * size;
  limit = std::min(std::sqrt(reach), task.sites.frame.scale * task.options.max_distance) + margin;
}

}  // namespace sdm::fields

#include "tile_totals.h"

#include <algorithm>
#include <cmath>
#include <limits>

using Json = nlohmann::ordered_json;

namespace {

double area_of(const sdm::Surface& surface) {
  std::vector<std::size_t> texels(surface.mesh().triangles.size());
  for (const std::uint32_t face : surface.texel_faces())
    if (face != sdm::kNone) ++texels[face];
  double area = 0;
  for (std::uint32_t face = 0; face < texels.size(); ++face) {
    if (texels[face] == 0) continue;
    const auto [u, v] = surface.texel_edges(face);
    area += static_cast<double>(texels[face]) *
            std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
  }
  return area;
}

const sdm::Extreme& farthest(const sdm::Extremes& extremes) {
  return -extremes.min.distance > extremes.max.distance ? extremes.min : extremes.max;
}

}  // namespace

void TileTotals::add(int udim, const Outcome& outcome, const sdm::Surface& surface,
                     const sdm::DistanceMap& map) {
  const bool first = tiles_.empty();
  tiles_.push_back({udim, area_of(surface), outcome.extremes, outcome.tolerance});
  statistics_.add(surface, map);
  if (first) {
    total_ = outcome;
    total_.numbers = {}, total_.notes.clear(), total_.raster.reset();
    return;
  }
  const auto extend = [](sdm::Extreme& most, const sdm::Extreme& other, bool farther) {
    if (std::isnan(most.distance) || farther) most = other;
  };
  const auto& [min, max] = outcome.extremes;
  extend(total_.extremes.min, min, min.distance < total_.extremes.min.distance);
  extend(total_.extremes.max, max, max.distance > total_.extremes.max.distance);
  total_.beyond_max_distance += outcome.beyond_max_distance;
  total_.boundary_texels += outcome.boundary_texels;
  total_.error_bound = std::max(total_.error_bound, outcome.error_bound);
}

const Outcome& TileTotals::finish() {
  total_.distance = statistics_.statistics();
  if (total_.tolerance) add_verdicts();
  return total_;
}

void TileTotals::add_verdicts() {
  const auto any = [&](sdm::Verdict verdict) {
    return std::ranges::any_of(tiles_, [&](const Tile& t) { return t.tolerance->verdict == verdict; });
  };
  sdm::ToleranceVerdict total{.tolerance = total_.tolerance->tolerance};
  total.verdict = any(sdm::Verdict::fail)          ? sdm::Verdict::fail
                  : any(sdm::Verdict::not_decided) ? sdm::Verdict::not_decided
                                                   : sdm::Verdict::pass;
  total.within = total.verdict != sdm::Verdict::fail;
  total.certified = total.verdict == sdm::Verdict::pass;
  double area = 0, deciding = std::numeric_limits<double>::infinity();
  for (const Tile& tile : tiles_) {
    const sdm::ToleranceVerdict& t = *tile.tolerance;
    total.largest = std::max(total.largest, t.largest);
    if (t.verdict == sdm::Verdict::fail) total.certified |= t.certified;
    if (t.verdict == sdm::Verdict::not_decided) deciding = std::min(deciding, t.deciding_bound);
    area += tile.area;
    total.shares.below += tile.area * t.shares.below;
    total.shares.within += tile.area * t.shares.within;
    total.shares.above += tile.area * t.shares.above;
    total.shares.without_value += tile.area * t.shares.without_value;
  }
  // What decides all tiles; 0 if nothing decides one of them.
  if (total.verdict == sdm::Verdict::not_decided) total.deciding_bound = deciding;
  if (area > 0)
    for (double* share :
         {&total.shares.below, &total.shares.within, &total.shares.above, &total.shares.without_value})
      *share /= area;
  total.exceeded_area_fraction = total.shares.below + total.shares.above + total.shares.without_value;
  total_.tolerance = total;
}

Json TileTotals::report() const {
  Json report;
  report["tiles"] = Json::array();
  for (const Tile& tile : tiles_) report["tiles"].push_back(tile.udim);
  report.update(measures_json(total_));
  std::vector<Tile> worst = tiles_;
  std::erase_if(worst, [](const Tile& tile) { return std::isnan(farthest(tile.extremes).distance); });
  std::ranges::stable_sort(worst, std::ranges::greater(),
                           [](const Tile& tile) { return std::abs(farthest(tile.extremes).distance); });
  report["worst"] = Json::array();
  for (const Tile& tile : worst) {
    const sdm::Extreme& most = farthest(tile.extremes);
    report["worst"].push_back({{"tile", tile.udim},
                               {"distance", most.distance},
                               {"point", most.point},
                               {"at", most.at_vertex ? "vertex" : "texel"}});
  }
  return report;
}

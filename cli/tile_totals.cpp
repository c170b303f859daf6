#include "tile_totals.h"

#include <algorithm>

#include "group_tolerances.h"
#include "src/io/json/report_json.h"

using Json = nlohmann::ordered_json;

void TileScale::add(const sdm::Surface& surface, const sdm::DistanceMap& map, double accuracy) {
  statistics_.add(surface, map);
  accuracy_ = std::max(accuracy_, accuracy);
}

sdm::ColorRange TileScale::colors(const sdm::PictureOptions& picture) const {
  sdm::ColorChoice choice = sdm::color_choice(picture);
  choice.accuracy = accuracy_;
  return sdm::color_range(choice, statistics_.statistics());
}

sdm::PictureOptions TileScale::texture(const sdm::PictureOptions& picture) const {
  return sdm::texture_range(picture, statistics_.statistics());
}

void TileTotals::add(int udim, const Outcome& outcome, const sdm::Surface& surface,
                     const sdm::DistanceMap& map) {
  if (tiles_.empty())
    first_ = outcome;
  else
    first_.boundary_vertices += outcome.boundary_vertices;
  if (outcome.groups) groups_.push_back(*outcome.groups);
  tiles_.push_back({udim, outcome.summary.extremes});
  combined_.add(surface, map, outcome.summary);
}

Outcome TileTotals::finish() const {
  Outcome total = first_;
  total.summary = combined_.summary();
  total.raster.reset();  // that of the first tile
  total.groups.reset();
  if (!groups_.empty()) total.groups = sdm::combined_groups(groups_, table_, doubted_);
  return total;
}

Json TileTotals::report() const {
  Json report;
  report["tiles"] = Json::array();
  for (const Tile& tile : tiles_) report["tiles"].push_back(tile.udim);
  report.update(sdm::to_json(combined_.summary()));
  if (const Outcome total = finish(); total.groups)
    report["group_tolerances"] = groups_json(*total.groups, total.summary);
  std::vector<Tile> worst = tiles_;
  std::erase_if(worst, [](const Tile& tile) { return !tile.extremes; });
  std::ranges::stable_sort(worst, std::ranges::greater(),
                           [](const Tile& tile) { return std::abs(farthest(*tile.extremes).distance); });
  report["worst"] = Json::array();
  for (const Tile& tile : worst) {
    const sdm::Extreme& most = farthest(*tile.extremes);
    report["worst"].push_back({{"tile", tile.udim},
                               {"distance", most.distance},
                               {"point", most.point},
                               {"at", most.at_vertex ? "vertex" : "texel"}});
  }
  return report;
}

// The numbers of all UDIM tiles of a mesh together.
#pragma once

#include <sdm/combined_statistics.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "report.h"

class TileTotals {
 public:
  /// Adds the numbers of a tile and its map, which need not be kept.
  void add(int udim, const Outcome& outcome, const sdm::Surface& surface, const sdm::DistanceMap& map);
  /// Statistics weighted by area over all tiles, the extremes, the largest error bound, and the verdict: FAIL
  /// if that of a tile is, PASS if that of all is.
  [[nodiscard]] const Outcome& finish();
  /// These as keys of report.json, `tiles`, and `worst`: of each tile its largest |distance|, the largest
  /// first. After finish().
  [[nodiscard]] nlohmann::ordered_json report() const;

 private:
  struct Tile {
    int udim;
    double area;  ///< of its texels
    sdm::Extremes extremes;
    std::optional<sdm::ToleranceVerdict> tolerance;
  };
  void add_verdicts();

  std::vector<Tile> tiles_;
  sdm::CombinedStatistics statistics_;
  Outcome total_;
};

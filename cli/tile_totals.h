// The numbers of all UDIM tiles of a mesh together.
#pragma once

#include <sdm/statistics.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "report.h"

/// The colours and grey values that all tiles share: those of their distances together.
class TileScale {
 public:
  void add(const sdm::Surface& surface, const sdm::DistanceMap& map, double accuracy);
  [[nodiscard]] sdm::ColorRange colors(const sdm::PictureOptions& picture) const;
  /// `picture` with the range of distance_texture.png.
  [[nodiscard]] sdm::PictureOptions texture(const sdm::PictureOptions& picture) const;

 private:
  sdm::CombinedStatistics statistics_;
  double accuracy_ = 0;
};

class TileTotals {
 public:
  /// `table`: of tolerances of groups, which outlives this; `doubted`: there are doubts about a pass.
  TileTotals(const std::vector<sdm::GroupTolerance>& table, bool doubted)
      : table_(table), doubted_(doubted) {}

  /// Adds the numbers of a tile and its map, which need not be kept.
  void add(int udim, const Outcome& outcome, const sdm::Surface& surface, const sdm::DistanceMap& map);
  /// As sdm::CombinedSummary has it.
  [[nodiscard]] Outcome finish() const;
  /// These as keys of report.json, `tiles`, and `worst`: of each tile its largest |distance|, the largest
  /// first.
  [[nodiscard]] nlohmann::ordered_json report() const;

 private:
  struct Tile {
    int udim;
    std::optional<sdm::Extremes> extremes;
  };

  const std::vector<sdm::GroupTolerance>& table_;
  bool doubted_;
  std::vector<Tile> tiles_;
  std::vector<sdm::GroupVerdicts> groups_;
  sdm::CombinedSummary combined_;
  Outcome first_;
};

// The maps over time of `sdm sequence`, of an atlas that may change.
#pragma once

#include <sdm/statistics.h>
#include <sdm/surface.h>

#include <cstdint>
#include <utility>
#include <vector>

/// What changes the atlas counts only when the next map is added: a frame may fail after it.
class TemporalRecorder {
 public:
  /// Before an edit of the surface.
  void before_edit(const sdm::Surface& surface) {
    if (texels_.empty()) texels_.assign(surface.texel_faces().begin(), surface.texel_faces().end());
  }
  /// The surface has another atlas.
  void before_restart() { restarts_ = true; }

  void add(const sdm::Surface& surface, const sdm::DistanceMap& map) {
    if (restarts_)
      maps_ = {};
    else if (!texels_.empty())
      maps_.follow_edit(texels_, surface);
    pass();
    maps_.add(map);
  }

  /// The maps over time in the present atlas of the surface.
  [[nodiscard]] sdm::TemporalMaps of(const sdm::Surface& surface) const {
    if (restarts_) return {};
    sdm::TemporalMaps maps = maps_;
    if (!texels_.empty()) maps.follow_edit(texels_, surface);
    return maps;
  }
  /// Up to the last map that was added.
  [[nodiscard]] const sdm::TemporalMaps& maps() const { return maps_; }
  /// The map of a frame that is among those with which resume() will continue.
  void pass() {
    texels_.clear();
    restarts_ = false;
  }
  void resume(sdm::TemporalMaps maps) { maps_ = std::move(maps); }

 private:
  sdm::TemporalMaps maps_;
  std::vector<std::uint32_t> texels_;  // the faces of the texels at the last map; empty: as now
  bool restarts_ = false;
};

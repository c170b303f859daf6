// What drawing a map needs besides polygons and a canvas: the trees, the bounds, and the order of drawing.
#pragma once

#include <sdm/error.h>
#include <sdm/gl.h>

#include <vector>

#include "closest/engine.h"
#include "core/stopwatch.h"
#include "gl/domain_tree.h"
#include "gl/pair_stream.h"
#include "gl/raster_report.h"
#include "gl/tile_tree.h"
#include "sites/sites_data.h"

namespace sdm::gl {

/// What to draw.
struct DrawTask {
  const Surface& surface;
  const TileTree& tile_tree;  ///< of the surface
  const sites::SitesData& sites;
  const GlOptions& gl;
  const engine::EngineOptions& options;
};

/// The power of two that scales distances up to `longest` below 1.
[[nodiscard]] double depth_scale(double longest);

class MapDrawing {
 public:
  /// Fills the report's times up to `bounds`. All references must outlive it. Throws sdm::Error if O1 is too
  /// far away for single precision.
  MapDrawing(const DrawTask& task, RasterReport& report);

  /// No sample is farther from O2, in the unit frame of O2; no larger distance is of interest.
  [[nodiscard]] double reach() const { return tree_.bound[0]; }
  /// The error of single precision, by which regions are enlarged.
  [[nodiscard]] double slack() const { return slack_; }

  /// Draws all pairs; fills the report's counts of pairs. Throws Cancelled.
  template <class Polygons, class Canvas>
  void draw(const Polygons& polygons, Canvas& canvas) {
    PairStream stream(index_, tree_, polygons, canvas, report_.time_ms);
    std::vector<DomainBlock> blocks = cut_into_blocks(tree_, kBlockTiles);
    Stopwatch watch;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      watch.lap();
      blocks[b].domains = domains_of(blocks[b]);
      report_.time_ms.refit += watch.lap();
      stream.draw(blocks[b], [&](double fraction) {
        const double done = (static_cast<double>(b) + fraction) / static_cast<double>(blocks.size());
        const Progress& progress = task_.options.progress;
        if (progress && !progress("raster", done)) throw Cancelled();
      });
      blocks[b].domains = {};
    }
    watch.lap();
    stream.finish();
    report_.time_ms.draw += watch.lap();
    store(stream.counts());
  }

 private:
  // The most tiles of O1 drawn together. A site's region and box are computed once per such set.
  static constexpr std::uint32_t kBlockTiles = 2048;

  [[nodiscard]] std::vector<PlanarDomain> domains_of(const DomainBlock& block) const;
  void store(const PairCounts& counts);

  const DrawTask& task_;
  RasterReport& report_;
  Stopwatch watch_;
  DomainTree tree_;
  SiteIndex index_;
  double slack_ = 0;
};

}  // namespace sdm::gl

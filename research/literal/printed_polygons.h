// The polygons that Algorithm 1 draws, with some corrections or none.
#pragma once

#include <array>
#include <vector>

#include "gl/polygons/oriented_box.h"
#include "gl/polygons/raster_polygon.h"
#include "research/literal/corrections.h"

namespace sdm::literal {

struct PrintedBatch : gl::RasterBatch {
  /// The distance vector at each corner; empty if fragments evaluate it.
  std::vector<std::array<float, 3>> corner_vectors;

  void clear() {
    RasterBatch::clear();
    corner_vectors.clear();
  }
  void append(const PrintedBatch& other);
};

/// As gl::SiteDescent takes them.
struct PrintedPolygons {
  using Batch = PrintedBatch;

  gl::RasterRules rules;
  double reach;  ///< no larger distance is of interest
  Corrections corrections;

  [[nodiscard]] gl::OrientedBox box(const gl::SiteRegion& region) const {
    return oriented_box(region, reach, corrections.margins ? rules.slack : 0);
  }
  /// The winner is site_code(), or with confirmation a face of O2.
  bool add(PrintedBatch& batch, const gl::SiteRegion& region, const gl::OrientedBox& box,
           const gl::PlanarDomain& domain) const;

 private:
  [[nodiscard]] bool cut(gl::ConvexPolygon& polygon, gl::HalfPlane wall) const;
  [[nodiscard]] bool clip(gl::ConvexPolygon& polygon, const gl::SiteRegion& region,
                          const gl::OrientedBox& box, const gl::PlanarDomain& domain) const;
};

}  // namespace sdm::literal

// A polygon to be drawn: the part of a domain inside a site's region, with the distance vector to the site.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "gl/polygons/corrections.h"
#include "gl/polygons/oriented_box.h"
#include "gl/polygons/planar_domain.h"
#include "gl/polygons/site_region.h"

namespace sdm::gl {

/// A record of the table that the vertex shader reads. An affine function is given by its value at `origin`,
/// the centre of a texel, and its change per texel to the right and down. Lengths are in units of
/// RasterRules.
struct RasterPolygon {
  float vector[3], origin_u;
  float vector_du[3], origin_v;
  float vector_dv[3];
  std::uint32_t winner;                    ///< a face of O2; without Corrections::confirmation, site_code()
  float walls[SiteRegion::kMostWalls][3];  ///< negative beyond them
  std::uint32_t domain;
};
inline constexpr int kTexelsPerPolygon = 7;
static_assert(sizeof(RasterPolygon) == kTexelsPerPolygon * sizeof(float[4]));

struct RasterCorner {
  float u, v;
  std::uint32_t polygon;
};

/// Polygons drawn together.
struct RasterBatch {
  std::vector<RasterPolygon> polygons;
  std::vector<RasterCorner> corners;  ///< of polygon i: first_corner[i] ... first_corner[i + 1]
  std::vector<std::uint32_t> first_corner{0};
  /// The distance vector at each corner; empty if fragments evaluate it.
  std::vector<std::array<float, 3>> corner_vectors;

  [[nodiscard]] std::size_t size() const { return polygons.size(); }
  void clear() {
    polygons.clear();
    corners.clear();
    first_corner.assign(1, 0);
    corner_vectors.clear();
  }
  void append(const RasterBatch& other);
};

struct RasterRules {
  double slack;     ///< walls are moved outwards by this, so that rounding opens no cracks
  double to_depth;  ///< a power of two that scales all distances of the map below 1
  Corrections corrections{};
};

/// A site as one number, not kNone. Indices of sites are below 2³⁰, for lack of memory.
[[nodiscard]] inline std::uint32_t site_code(SiteType type, std::uint32_t site) {
  return static_cast<std::uint32_t>(type) << 30 | site;
}
[[nodiscard]] inline std::pair<SiteType, std::uint32_t> site_of(std::uint32_t code) {
  return {static_cast<SiteType>(code >> 30), code & ~(3u << 30)};
}

/// Clips the domain's outline by the walls of the region and adds the result to the batch, unless it is
/// empty. `box` is that of the region. Returns whether it was added.
bool add_polygon(RasterBatch& batch, const SiteRegion& region, const OrientedBox& box,
                 const PlanarDomain& domain, const RasterRules& rules);

}  // namespace sdm::gl

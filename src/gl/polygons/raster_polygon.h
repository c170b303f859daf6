// A polygon to be drawn: the part of a domain inside a site's region, with the distance vector to the site.
#pragma once

#include <span>
#include <vector>

#include "gl/polygons/convex_polygon.h"
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
  std::uint32_t winner;                    ///< a face of O2
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

  [[nodiscard]] std::size_t size() const { return polygons.size(); }
  void clear() {
    polygons.clear();
    corners.clear();
    first_corner.assign(1, 0);
  }
  void append(const RasterBatch& other);
};

struct RasterRules {
  double slack;     ///< walls are moved outwards by this, so that rounding opens no cracks
  double to_depth;  ///< a power of two that scales all distances of the map below 1
};

/// The wall restricted to the domain's plane.
[[nodiscard]] HalfPlane restrict(const HalfSpace& wall, const PlanarDomain& domain);

/// The centre of the texel at which the affine functions of a polygon with these corners have their values.
[[nodiscard]] Vec2 base_point(std::span<const Vec2> corners);

/// Appends a polygon with the distance vector to the site, without walls, whose winner is the region's face.
RasterPolygon& append_polygon(RasterBatch& batch, std::span<const Vec2> corners, const SiteRegion& region,
                              const PlanarDomain& domain, double to_depth);

/// Sets wall k of a polygon, moved outwards by the slack.
void set_wall(RasterPolygon& polygon, int k, const HalfPlane& wall, const Vec2& base,
              const RasterRules& rules);

/// Clips the domain's outline by the walls of the region and adds the result to the batch, unless it is
/// empty. Returns whether it was added.
bool add_polygon(RasterBatch& batch, const SiteRegion& region, const PlanarDomain& domain,
                 const RasterRules& rules);

}  // namespace sdm::gl

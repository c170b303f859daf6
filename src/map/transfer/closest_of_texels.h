// The points of O2 that the texels of a map are closest to.
#pragma once

#include <sdm/map.h>

#include "geometry/barycentric.h"
#include "sites/sites_data.h"
#include "surface/surface_data.h"

namespace sdm::map {

/// Finds the points texel by texel. Consecutive texels often have the same closest face, whose frame is kept:
/// a walk along rows is fastest, and each thread needs a walk of its own.
class ClosestOfTexels {
 public:
  /// All must outlive this and not change. The map is one from the surface to the sites.
  ClosestOfTexels(const Surface& surface, const Sites& sites, const DistanceMap& map);

  /// The point on O2 where the vector of an owned texel ends; no face for a texel without a value. Throws
  /// sdm::Error if the map names a site that does not exist.
  [[nodiscard]] SurfacePoint at(std::uint32_t texel);

 private:
  /// Sets `found` to the point of the open face under the query, if there is one beyond doubt.
  [[nodiscard]] bool in_face(std::uint32_t face, const Vec3& query, SurfacePoint& found);
  /// Where the vector ends, on a face that need not be closest there.
  [[nodiscard]] SurfacePoint end_of_vector(std::uint32_t texel, const Vec3& point) const;
  /// The closest point of a site that need not be the closest one of O2.
  [[nodiscard]] SurfacePoint on_site(SiteType type, std::uint32_t site, const Vec3& query) const;

  const surface::SurfaceData& surface_;
  const Sites& sites_;
  const sites::SitesData& data_;
  const DistanceMap& map_;
  std::uint32_t face_ = kNone;  ///< whose frame it is
  BarycentricFrame frame_;
};

}  // namespace sdm::map

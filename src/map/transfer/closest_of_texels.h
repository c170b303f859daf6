// The points of O2 that the texels of a map are closest to.
#pragma once

#include <sdm/map.h>

#include <span>

#include "geometry/barycentric.h"
#include "sites/sites_data.h"
#include "surface/surface_data.h"

namespace sdm::map {

/// The face of a site whose outward normal has the largest product with this one; of several, the first.
[[nodiscard]] std::uint32_t face_that_faces(const sites::SitesData& data, SiteType type, std::uint32_t site,
                                            const Vec3& normal);

/// Finds the points texel by texel. Consecutive texels often have the same closest site, of which the last
/// one is kept: a walk along rows is fastest, and each thread needs a walk of its own.
class ClosestOfTexels {
 public:
  /// All must outlive this and not change. The map is one from the surface to the sites. `normals`:
  /// outward_normals() of the surface. With them, in maps of DistanceKind::facing, the face around an edge or
  /// a vertex is the one that faces as the sample does; otherwise it is any.
  ClosestOfTexels(const Surface& surface, const Sites& sites, const DistanceMap& map,
                  std::span<const Vec3> normals = {});

  /// The point on O2 where the vector of an owned texel ends; no face for a texel without a value. Throws
  /// sdm::Error if the map names a site that does not exist.
  [[nodiscard]] SurfacePoint at(std::uint32_t texel);

 private:
  /// A point of a site, with parameters that depend on its type.
  struct Site {
    SiteType type = SiteType::none;
    std::uint32_t number = kNone, face = kNone;
    std::array<std::uint32_t, 2> ends{};  ///< of a vertex, the first one; of an edge, both
    Vec3 origin{}, along{};               ///< of an edge: the parameter of q is (q − origin) · along
    BarycentricFrame frame{};             ///< of a face
  };

  void read(SiteType type, std::uint32_t number);
  [[nodiscard]] SurfacePoint in_face(const Vec3& query) const;
  /// Where the vector ends, on a face that need not be closest there.
  [[nodiscard]] SurfacePoint end_of_vector(std::uint32_t texel, const Vec3& point) const;

  const surface::SurfaceData& surface_;
  const sites::SitesData& data_;
  const DistanceMap& map_;
  std::span<const Vec3> normals_;
  bool ends_elsewhere_;
  std::uint32_t row_ = 0,
                row_begin_ = 0;  ///< of the last texel, and the first texel there: divisions take long
  Site site_;
};

}  // namespace sdm::map

// Contacts of points with a solid, from closest points.
#pragma once

#include <sdm/sites.h>

#include <span>
#include <vector>

namespace sdm::scenes {

/// A point inside a solid, or less than a margin outside its surface.
struct VertexContact {
  std::uint32_t point = 0;  ///< index of the point
  Triangle face{};          ///< the face that contains the closest point of the surface
  Vec3 weights{};           ///< barycentric coordinates of the closest point
  Vec3 normal{};            ///< (point − closest point) / signed distance: unit length, outward
  double depth = 0;         ///< margin − signed distance, > 0
};

/// Finds the points whose signed distance to the solid (negative inside) is below `margin`, in order. Points
/// exactly on the surface are skipped, as they have no normal.
[[nodiscard]] std::vector<VertexContact> find_contacts(std::span<const Vec3> points, const Sites& solid,
                                                       double margin);

}  // namespace sdm::scenes

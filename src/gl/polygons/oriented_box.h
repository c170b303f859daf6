// Oriented boxes around regions of influence: the culling test of the paper (4.2).
#pragma once

#include <array>

#include "gl/polygons/site_region.h"
#include "tree/aabb_tree.h"

namespace sdm::gl {

/// centre ± half[k] axes[k]; the axes are orthonormal.
struct OrientedBox {
  Vec3 centre{};
  std::array<Vec3, 3> axes{};
  Vec3 half{};
};

/// Contains the part of the region within `reach` of its site, enlarged by `slack`.
[[nodiscard]] OrientedBox oriented_box(const SiteRegion& region, double reach, double slack);

/// Whether the boxes may meet, by the six face normals. The nine cross products of edges, which would
/// complete the separating axis test, rarely separate boxes that these do not (Gottschalk et al. 1996; van
/// den Bergen 1997); clipping decides the rest.
[[nodiscard]] bool may_meet(const OrientedBox& box, const tree::FloatBox& other);

}  // namespace sdm::gl

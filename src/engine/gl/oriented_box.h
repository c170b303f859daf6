// Oriented boxes around regions of influence: the culling test of the paper (4.2).
#pragma once

#include <array>

#include "engine/gl/site_region.h"
#include "hierarchy/aabb_tree.h"

namespace sdm::gl {

/// centre ± half[k] axes[k]; the axes are orthonormal.
struct OrientedBox {
  Vec3 centre{};
  std::array<Vec3, 3> axes{};
  Vec3 half{};
};

/// Contains all of the region that is within `reach` of its site, and `slack` around it.
[[nodiscard]] OrientedBox oriented_box(const SiteRegion& region, double reach, double slack);

/// Whether the boxes may meet: by the six directions of their faces. The nine products of edges, which would
/// make the separating axis test complete, rarely separate what these do not (Gottschalk et al. 1996; van den
/// Bergen 1997); clipping decides what is left.
[[nodiscard]] bool may_meet(const OrientedBox& box, const hierarchy::FloatBox& other);

}  // namespace sdm::gl

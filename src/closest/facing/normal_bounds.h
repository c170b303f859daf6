// What bounds the normals of many faces at once, kept with the sites.
#pragma once

#include <vector>

#include "closest/facing/normal_cones.h"
#include "core/lazy/kept.h"
#include "sites/sites_data.h"
#include "tree/aabb_tree.h"

namespace sdm::facing {

struct NormalBounds {
  std::vector<Cone> cones;         ///< normal_cones()
  Kept<tree::AabbTree> by_normal;  ///< normal_tree(), which most searches do without
};

/// Those of the present shape, valid until it changes. Cost: linear in the faces for the first call, then
/// O(1).
[[nodiscard]] const NormalBounds& normal_bounds_of(const sites::SitesData& sites);

}  // namespace sdm::facing

// The closest point in plain code that is easy to verify: the oracle for all other searches, which nothing
// but tests and the engine `reference` may call. It shares the order in which a tree is visited with them,
// but neither bounds nor what decides between faces; a test compares it with all faces, one by one.
#pragma once

#include <sdm/sites.h>

#include "sites/sites_data.h"

namespace sdm::reference {

/// Scalar, double precision; accurate to rounding. The first of all faces by (distance, type, site, face):
/// the result depends on the faces only, not on the tree.
[[nodiscard]] ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& q,
                                             double max_distance);

}  // namespace sdm::reference

// The closest point in plain code that is easy to verify: the oracle for all other searches.
#pragma once

#include "sites/sites_data.h"

namespace sdm::closest {

/// No face is excluded unless its box is farther than the best distance by this fraction of the distance and
/// of the size of O2. The distances of slivers that are computed from normals are accurate to 1e-7.
constexpr double kSlack = 1e-6;

/// Scalar, double precision, nearest child first over the binary tree; all results are accurate to rounding.
/// The first of all faces by (distance, type, site, face): the result depends on the faces only, not on the
/// tree.
[[nodiscard]] ClosestPoint reference_closest(const sites::SitesData& sites, const Vec3& point,
                                             double max_distance);

}  // namespace sdm::closest

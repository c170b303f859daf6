// The closest point of one face, and of the faces around it, in double precision.
#pragma once

#include <sdm/sites.h>

#include "sites/sites_data.h"

namespace sdm::sites {

/// The point of the closed triangle that is closest to q, and which of its sites it lies on.
[[nodiscard]] ClosestPoint closest_on_face(const SitesData& sites, std::uint32_t face, const Vec3& q);

/// Starts with closest_on_face(face) and moves to neighbouring faces while they are strictly closer: a local
/// minimum of the distance over the mesh, to double rounding. This makes a site selected in single precision
/// consistent with its neighbourhood, as pseudonormals require.
[[nodiscard]] ClosestPoint closest_around_face(const SitesData& sites, std::uint32_t face, const Vec3& q);

/// closest_on_face() of a face around the site whose point closest to q lies on that site, if there is one,
/// otherwise of the first face around it.
[[nodiscard]] ClosestPoint closest_around_site(const SitesData& sites, SiteType type, std::uint32_t site,
                                               const Vec3& q);

}  // namespace sdm::sites

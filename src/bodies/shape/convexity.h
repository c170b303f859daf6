// Whether a solid is convex, and by how much it is not.
#pragma once

#include "inside/inside.h"
#include "sites/sites_data.h"

namespace sdm::shape {

/// How much a solid falls short of the convex hull of its vertices: 0 if it is the hull, decided exactly,
/// also with faces in one plane and faces without area. Otherwise some d > 0 such that the hull, scaled by 1
/// − d about a point, is inside the solid; infinite if that is more than kNearlyConvex, as for a surface
/// without an inside. A cube that was turned has faces of two triangles in different planes, by rounding.
///
/// Let c be a point below the planes of all faces, at the distance h of one, and let no vertex be above that
/// one by more than e. The planes of all faces contain the hull scaled by the least h / (h + e) about c. And
/// a point below all of them sees all faces from their inner side: the mesh winds around it.
///
/// Cost: of a convex mesh, O(n log n); of others, that of a few faces as a rule.
[[nodiscard]] double convexity_deficit(const sites::SitesData& sites, const inside::InsideTest& inside);

/// The deficit that the rounding of coordinates to single precision causes.
inline constexpr double kNearlyConvex = 2.5e-7;

}  // namespace sdm::shape

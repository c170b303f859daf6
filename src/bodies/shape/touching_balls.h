// The balls inside a solid that touch a part of its surface.
#pragma once

#include "inside/face_sides.h"
#include "sites/sites_data.h"

namespace sdm::shape {

/// A triangle in the plane of a face, and the largest angle between the outward normal of that face and the
/// way from a point inside to its closest point in the triangle, at most a right angle.
struct TouchedTriangle {
  Corners at{};
  Vec3 normal{};
  double angle = 0;
};

/// Bounds the depth of the points inside the solid whose closest point of the boundary is in the triangle:
/// the radius of the balls that touch it there and contain no boundary. Infinite if one may be larger than
/// `most`, or if no bound is found in some tens of searches for a closest point.
///
/// Let n be the normal, x the closest point of p, b = |p − x|, and c the cosine of the angle between x − p
/// and n, cos(angle) ≤ c ≤ 1. With x′ the point of the plane that p is straight below, p = x′ − b c n. For a
/// convex part H of the boundary, |x′ − r c n − H| − r is convex in x′ and r, and grows no more with r. So if
/// it is negative for some r, it stays so, and the least such r, ρ(x′), is convex, too. If it is negative for
/// r = b, H is closer to p than x, a contradiction: so b ≤ ρ(x′) for one c. For a given b, the distance from
/// H is convex in c: if it is less than b at both ends, so it is between. Hence b is at most the larger ρ of
/// both ends, which is convex and so largest at a corner of a triangle, and mixed_bound() holds for several
/// H. x′ is in the triangle enlarged by b sin(angle).
[[nodiscard]] double bound_of_touching_balls(const sites::SitesData& solid, const inside::FaceSides& sides,
                                             const TouchedTriangle& triangle, double most);

}  // namespace sdm::shape
